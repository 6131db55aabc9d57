//! Every reader with files that are truncated, empty, of another kind, too large or noise: one error that names the
//! file, never a panic, and no memory for data that a header only promises.

use std::path::Path;

use proptest::prelude::*;
use viewsphere::frame::{FlowField, Frame, Image, PixelFormat, Plane, Size, UNKNOWN_FLOW};
use viewsphere::io::{Frames, RawReader, Y4mReader, Y4mWriter, flo, kitti, npy, picture, sequence};
use viewsphere::{Error, Result};

const NAME: &str = "some-file";

/// A reader's result in a common form: the values as bytes.
type Reader = fn(&[u8]) -> Result<Vec<u8>>;

fn flow_bytes(flow: FlowField) -> Vec<u8> {
    flow.validate().unwrap();
    flow.data.iter().flatten().flat_map(|v| v.to_le_bytes()).collect()
}

fn image_bytes(image: Image) -> Vec<u8> {
    image.frame().unwrap();
    image.data
}

fn video_bytes(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut video = Y4mReader::new(bytes, NAME)?;
    let (mut image, mut all) = (Image::default(), Vec::new());
    while video.next_frame(&mut image)? {
        all.extend(image_bytes(image.clone()));
    }
    Ok(all)
}

/// A reader, the bytes of a small complete file, and the number of bytes that may be missing at its end without a loss.
struct Case {
    name: &'static str,
    read: Reader,
    bytes: Vec<u8>,
    spare: usize,
}

fn flow() -> FlowField {
    let data = (0..15).map(|i| [i as f32 / 4.0 - 2.0, 1.5 - i as f32 / 2.0]).collect();
    FlowField { size: Size::new(5, 3), data }
}

fn gray() -> Image {
    let data = (0..80 * 3).map(|i| (i * i % 251) as u8).collect();
    Image { size: Size::new(80, 3), format: PixelFormat::Gray8, data }
}

fn jpeg() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 90);
    encoder.encode(&gray().data, 80, 3, image::ExtendedColorType::L8).unwrap();
    bytes
}

fn y4m(format: PixelFormat, frames: usize) -> Vec<u8> {
    let size = Size::new(4, 3);
    let mut video = Y4mWriter::new(Vec::new(), NAME, size, format, (25, 1)).unwrap();
    for frame in 0..frames {
        let data = vec![frame as u8 * 40; size.pixels() * format.bytes()];
        video.write_frame(&Frame::new(size, format, &data).unwrap()).unwrap();
    }
    video.finish().unwrap()
}

fn cases() -> Vec<Case> {
    let plane = Plane { size: Size::new(3, 2), data: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0] };
    let mut pgm = b"P5\n80 3\n255\n".to_vec();
    pgm.extend(&gray().data);
    let picture: Reader = |b| picture::decode(Path::new(NAME), b).map(image_bytes);
    let case = |name, read, bytes| Case { name, read, bytes, spare: 0 };
    vec![
        case("flo", |b| flo::decode(Path::new(NAME), b).map(flow_bytes), flo::encode(&flow()).unwrap()),
        // The end chunk of a PNG carries nothing; its 12 bytes may be missing.
        Case {
            spare: 12,
            ..case(
                "kitti",
                |b| kitti::decode(Path::new(NAME), b).map(flow_bytes),
                kitti::encode(&flow()).unwrap(),
            )
        },
        case("npy", |b| npy::decode(Path::new(NAME), b).map(flow_bytes), npy::encode(&flow()).unwrap()),
        case(
            "npy plane",
            |b| {
                let plane = npy::decode_plane(Path::new(NAME), b)?;
                plane.validate().unwrap();
                Ok(plane.data.iter().flat_map(|v| v.to_le_bytes()).collect())
            },
            npy::encode_plane(&plane).unwrap(),
        ),
        Case { spare: 12, ..case("png", picture, picture::encode_png(&gray()).unwrap()) },
        case("jpeg", picture, jpeg()),
        case("pgm", picture, pgm),
        case("y4m gray", video_bytes, y4m(PixelFormat::Gray8, 3)),
        case("y4m colour", video_bytes, y4m(PixelFormat::Rgb8, 3)),
    ]
}

fn names_the_file(error: &Error, context: &str) {
    let text = error.to_string();
    assert!(text.starts_with(NAME), "{context}: {text:?} does not name the file");
    assert!(!text.contains('\n'), "{context}: {text:?} has more than one line");
}

#[test]
fn whole_files_are_read_and_every_prefix_is_refused() {
    for Case { name, read, bytes, spare } in cases() {
        let whole = read(&bytes).unwrap();
        assert!(!whole.is_empty(), "{name}");
        for length in 0..bytes.len() {
            let context = format!("{name} cut to {length} of {} bytes", bytes.len());
            match read(&bytes[..length]) {
                Err(error) => names_the_file(&error, &context),
                Ok(found) if name.starts_with("y4m") => {
                    // A video may end after any whole frame, and only there.
                    assert!(whole.starts_with(&found), "{context}");
                    let per_frame = if name == "y4m gray" { 12 } else { 36 };
                    let header = bytes.iter().position(|&b| b == b'\n').unwrap() + 1;
                    assert_eq!((length - header) % (6 + per_frame), 0, "{context} was taken as whole");
                }
                Ok(found) => {
                    assert!(length + spare >= bytes.len(), "{context} was taken as whole");
                    assert_eq!(found, whole, "{context}");
                }
            }
        }
    }
}

#[test]
fn other_kinds_and_empty_files_are_refused() {
    for Case { name, read, bytes, .. } in cases() {
        for other in [&b""[..], b"\0", b"hello, world", b"GIF89a\x01\0\x01\0\0\0\0;", &[0xFF; 64]] {
            names_the_file(&read(other).unwrap_err(), name);
        }
        for at in 0..2 {
            let mut wrong = bytes.clone();
            wrong[at] ^= 0x55;
            names_the_file(&read(&wrong).unwrap_err(), name);
        }
    }
}

/// A PNG whose header states another size, with a correct checksum of the header.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = picture::encode_png(&gray()).unwrap();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = bytes[12..29].iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
    });
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}

#[test]
fn the_forged_png_is_legal_when_its_size_is() {
    let original = picture::encode_png(&gray()).unwrap();
    assert_eq!(png_of(80, 3), original, "the checksum of the forger must be the right one");
}

#[test]
fn headers_that_promise_too_much_are_refused_at_once() {
    let flo = |w: i32, h: i32| {
        let mut bytes = b"PIEH".to_vec();
        bytes.extend(w.to_le_bytes().iter().chain(&h.to_le_bytes()));
        bytes
    };
    let npy = |shape: &str| {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes
    };
    let read = |name| cases().into_iter().find(|case| case.name == name).unwrap().read;
    let (flo_read, npy_read, picture) = (read("flo"), read("npy"), read("png"));
    for (w, h) in [(16384, 16384), (i32::MAX, i32::MAX), (-1, 5), (0, 5), (5, 0), (i32::MIN, i32::MIN)] {
        names_the_file(&flo_read(&flo(w, h)).unwrap_err(), "flo");
    }
    for shape in
        ["(16384, 16384, 2)", "(18446744073709551615, 2, 2)", "(0, 0, 2)", "()", "(2,)", "(1, 1, 2, 1)"]
    {
        names_the_file(&npy_read(&npy(shape)).unwrap_err(), shape);
    }
    let mut long = b"\x93NUMPY\x02\x00\xFF\xFF\xFF\xFF".to_vec();
    names_the_file(&npy_read(&long).unwrap_err(), "npy header");
    long.resize(1 << 16, b' ');
    names_the_file(&npy_read(&long).unwrap_err(), "npy header");
    for (w, h) in [(16385, 1), (1, u32::MAX >> 1), (0, 3), (81, 3), (80, 4)] {
        names_the_file(&picture(&png_of(w, h)).unwrap_err(), "png");
    }
    names_the_file(&picture(b"P5 0 0 255 ").unwrap_err(), "pnm");
    // Legal sizes that no file of this length can hold: found before the pixels are read.
    let short: [&[u8]; 4] =
        [&png_of(16384, 16384), b"P5 16384 16384 255 x", b"P6 16384 16384 65535 x", b"P4 16384 16384 x"];
    for bytes in short {
        let text = picture(bytes).unwrap_err().to_string();
        assert!(text.contains("size is 16384×16384, expected at most"), "{text}");
    }
    let text = picture(b"P6 4294967295 4294967295 255 x").unwrap_err().to_string();
    assert!(text.starts_with(NAME), "{text}");
    let mut jpeg = jpeg();
    let frame = jpeg.windows(2).position(|pair| pair == [0xFF, 0xC0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0x40, 0, 0x40, 0]);
    let text = picture(&jpeg).unwrap_err().to_string();
    assert!(text.contains("size is 16384×16384"), "{text}");
    // A stream has no length to check, but the memory grows only with the data received.
    names_the_file(&video_bytes(b"YUV4MPEG2 W16384 H16384 Cmono16\nFRAME\nabc").unwrap_err(), "y4m");
    names_the_file(&video_bytes(b"YUV4MPEG2 W16385 H16384\nFRAME\nabc").unwrap_err(), "y4m");
}

#[test]
fn a_length_that_does_not_fit_the_size_is_refused() {
    for Case { name, read, mut bytes, .. } in cases() {
        if name.starts_with("flo") || name.starts_with("npy") {
            bytes.extend([0; 8]);
            let text = read(&bytes).unwrap_err().to_string();
            assert!(text.contains("file length"), "{name}: {text}");
        }
    }
}

#[test]
fn files_that_are_not_there_are_named() {
    for read in [flo::read, kitti::read, npy::read] as [fn(&'static str) -> Result<FlowField>; 3] {
        assert!(
            matches!(read("no-such-file"), Err(Error::Io { path, .. }) if path == Path::new("no-such-file"))
        );
    }
    assert!(matches!(picture::read("no-such-file"), Err(Error::Io { .. })));
    assert!(matches!(npy::read_plane("no-such-file"), Err(Error::Io { .. })));
    let folder = std::env::temp_dir();
    assert!(matches!(picture::read(&folder), Err(Error::Io { path, .. }) if path == folder));
}

#[test]
fn content_counts_and_not_the_name() {
    let folder = tempfile::tempdir().unwrap();
    for Case { name, bytes, .. } in cases().into_iter().filter(|c| ["png", "pgm", "jpeg"].contains(&c.name)) {
        for extension in ["PNG", "Jpg", "pgm", "dat"] {
            let path = folder.path().join(format!("{name}.{extension}"));
            std::fs::write(&path, &bytes).unwrap();
            let image = picture::read(&path).unwrap();
            assert_eq!(
                (image.size, image.format),
                (Size::new(80, 3), PixelFormat::Gray8),
                "{name}.{extension}"
            );
        }
    }
}

fn any_flow() -> impl Strategy<Value = FlowField> {
    (1..9_u32, 1..9_u32).prop_flat_map(|(w, h)| {
        let component = prop_oneof![8 => -700.0_f32..700.0, 1 => any::<f32>()];
        prop::collection::vec([component.clone(), component], (w * h) as usize)
            .prop_map(move |data| FlowField { size: Size::new(w, h), data })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn flo_keeps_every_known_value_bit_by_bit(flow in any_flow()) {
        let back = flo::decode(Path::new(NAME), &flo::encode(&flow).unwrap()).unwrap();
        prop_assert_eq!(back.size, flow.size);
        for (&a, &b) in flow.data.iter().zip(&back.data) {
            let expected = if FlowField::is_known(a) { a } else { [UNKNOWN_FLOW; 2] };
            prop_assert_eq!(b.map(f32::to_bits), expected.map(f32::to_bits));
        }
    }

    #[test]
    fn npy_keeps_every_value_bit_by_bit(flow in any_flow()) {
        let back = npy::decode(Path::new(NAME), &npy::encode(&flow).unwrap()).unwrap();
        prop_assert_eq!(back.size, flow.size);
        for (a, b) in flow.data.iter().zip(&back.data) {
            prop_assert_eq!(a.map(f32::to_bits), b.map(f32::to_bits));
        }
    }

    #[test]
    fn kitti_keeps_what_it_can_hold_to_half_a_step(flow in any_flow()) {
        let back = kitti::decode(Path::new(NAME), &kitti::encode(&flow).unwrap()).unwrap();
        prop_assert_eq!(back.size, flow.size);
        for (a, b) in flow.data.iter().zip(&back.data) {
            if a.iter().all(|c| (-512.0..=511.98).contains(c)) {
                for (x, y) in a.iter().zip(b) {
                    prop_assert!((x - y).abs() <= 0.5 / 64.0, "{x} became {y}");
                }
            } else if a.iter().any(|c| c.is_nan() || c.abs() > 512.01) {
                prop_assert_eq!(*b, [UNKNOWN_FLOW; 2]);
            }
        }
    }

    #[test]
    fn png_keeps_every_byte(w in 1..20_u32, h in 1..20_u32, seed in any::<u8>()) {
        for format in [PixelFormat::Gray8, PixelFormat::Gray16, PixelFormat::Rgb8, PixelFormat::Rgba8] {
            let size = Size::new(w, h);
            let data = (0..size.pixels() * format.bytes()).map(|i| (i as u8).wrapping_mul(seed)).collect();
            let image = Image { size, format, data };
            let back = picture::decode(Path::new(NAME), &picture::encode_png(&image).unwrap()).unwrap();
            prop_assert_eq!(back, image);
        }
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for Case { read, .. } in cases() {
            let _ = read(&bytes);
        }
        let raw = RawReader::new(&bytes[..], NAME, Size::new(7, 5)).unwrap();
        prop_assert_eq!(count(raw), bytes.len() / 35);
    }

    /// Noise after a correct header, and single wrong bytes, test deeper than noise alone.
    #[test]
    fn damaged_files_never_panic(
        keep in 0.0..1.0_f64,
        noise in prop::collection::vec(any::<u8>(), 0..60),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        for Case { read, bytes, .. } in cases() {
            let mut cut = bytes[..(bytes.len() as f64 * keep) as usize].to_vec();
            cut.extend(&noise);
            let _ = read(&cut);
            let mut flipped = bytes;
            for (at, value) in &flips {
                let at = at.index(flipped.len());
                flipped[at] = *value;
            }
            let _ = read(&flipped);
        }
    }

    #[test]
    fn any_text_is_a_pattern_or_an_error(text in "[%*?d0-9a.]{0,12}") {
        let _ = sequence::expand(&text);
        let folder = format!("no-such-folder/{text}");
        let _ = Frames::open(&[folder], None);
    }

    #[test]
    fn natural_order_is_an_order(a in "[a01.]{0,6}", b in "[a01.]{0,6}", c in "[a01.]{0,6}") {
        use sequence::natural;
        prop_assert_eq!(natural(&a, &b), natural(&b, &a).reverse());
        prop_assert_eq!(natural(&a, &b).is_eq(), a == b);
        if natural(&a, &b).is_lt() && natural(&b, &c).is_lt() {
            prop_assert!(natural(&a, &c).is_lt());
        }
    }
}

/// The number of complete frames before the end or the error.
fn count(mut raw: RawReader<&[u8]>) -> usize {
    let mut image = Image::default();
    while matches!(raw.next_frame(&mut image), Ok(true)) {}
    raw.frames_read() as usize
}
