//! Camera files. Each format has its own module; [`read`] detects the format.

pub mod kalibr;
pub mod opencv;
pub mod ros;
mod yaml;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use self::yaml::Yaml;
use crate::camera::{Camera, Lens};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::io::write_bytes;

/// The longest camera file: OpenCV's may hold every corner that was detected.
const MAX_FILE: u64 = 64 << 20;

/// Formats that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenCV's FileStorage YAML.
    OpenCv,
    /// ROS's camera_info YAML.
    Ros,
    /// Kalibr's camchain YAML, with the camera as `cam0`.
    Kalibr,
}

/// Reads a camera from a file of OpenCV, ROS, Kalibr (its `cam0`) or EuRoC, and validates it with
/// [`Camera::validate`].
///
/// # Errors
/// [`Error::Io`]; [`Error::Format`] naming the key that is missing or wrong, or the parameter that is implausible.
pub fn read(path: impl AsRef<Path>) -> Result<Camera> {
    let path = path.as_ref();
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|source| Error::io(path, source))?;
    file.take(MAX_FILE + 1).read_to_end(&mut bytes).map_err(|source| Error::io(path, source))?;
    if bytes.len() as u64 > MAX_FILE {
        let expected = format!("at most {MAX_FILE} bytes");
        return Err(Error::format(path, "file length", format!("over {MAX_FILE} bytes"), expected));
    }
    let camera = decode(path, &bytes)?;
    camera.validate().map_err(|error| in_file(path, error))?;
    Ok(camera)
}

/// Decodes a camera from the bytes of a file of any of the formats, not yet validated by [`Camera::validate`]. `path`
/// is the name for error messages.
///
/// # Errors
/// [`Error::Format`] as in [`read`].
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Camera> {
    let text = text(path, bytes)?;
    let yaml = Yaml::parse(path, text)?;
    if yaml.keys().iter().any(|key| key.starts_with("cam") && yaml.has(&format!("{key}/intrinsics"))) {
        return kalibr::from_yaml(&yaml, "cam0");
    }
    if yaml.has("intrinsics") {
        // EuRoC's sensor.yaml.
        return kalibr::from_sensor(&yaml, "distortion_coefficients", "radial-tangential");
    }
    if yaml.has("k") || yaml.has("distortion_model") {
        return ros::from_yaml(&yaml);
    }
    if yaml.has("camera_matrix/data") {
        return opencv::from_yaml(&yaml);
    }
    let found = match yaml.keys()[..] {
        [] => "without a key".to_owned(),
        ref keys => format!("one with the keys {}", keys[..keys.len().min(6)].join(", ")),
    };
    let expected =
        "the YAML of OpenCV (camera_matrix), ROS (distortion_model), Kalibr (cam0) or EuRoC (intrinsics)";
    Err(Error::format(path, "camera file", found, expected))
}

/// Writes a camera to a file.
///
/// # Errors
/// [`Error::Io`]; [`Error::Parameter`] if the format cannot hold the lens.
pub fn write(path: impl AsRef<Path>, camera: &Camera, format: Format) -> Result<()> {
    let bytes = match format {
        Format::OpenCv => opencv::encode(camera),
        Format::Ros => ros::encode(camera),
        Format::Kalibr => kalibr::encode(camera)?,
    };
    write_bytes(path, &bytes)
}

/// Turns an error about a parameter into one about the file that states it.
fn in_file(path: &Path, error: Error) -> Error {
    match error {
        Error::Parameter { name, value, expected } => Error::format(path, name, value, expected),
        other => other,
    }
}

fn text<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str> {
    std::str::from_utf8(bytes).map_err(|_| {
        let found = format!("{:02x?}", &bytes[..bytes.len().min(8)]);
        Error::format(path, "camera file", found, "text in UTF-8")
    })
}

fn lens(path: &Path, key: &'static str, coefficients: &[f64]) -> Result<Lens> {
    Lens::new(coefficients).map_err(|_| {
        let expected = "0, 4, 5 or 8, in the order k1 k2 p1 p2 k3 k4 k5 k6";
        Error::format(path, key, format_args!("{} numbers", coefficients.len()), expected)
    })
}

fn from_intrinsics(size: Size, [f_u, f_v, u_0, v_0]: [f64; 4], lens: Lens) -> Camera {
    Camera { size, f_u, f_v, u_0, v_0, lens }
}

fn from_matrix(path: &Path, size: Size, matrix: [f64; 9], lens: Lens) -> Result<Camera> {
    let [f_u, skew, u_0, below, f_v, v_0, rest @ ..] = matrix;
    if skew != 0.0 {
        return Err(Error::format(path, "skew of the camera matrix", skew, "0"));
    }
    if below != 0.0 || rest != [0.0, 0.0, 1.0] {
        let expected = "f_u 0 u_0, 0 f_v v_0, 0 0 1";
        return Err(Error::format(path, "camera matrix", format!("{matrix:?}"), expected));
    }
    Ok(from_intrinsics(size, [f_u, f_v, u_0, v_0], lens))
}

/// A number in 17 digits, which is exact, with a point and a signed exponent, without which some YAML readers take it
/// for a word.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0.".to_owned();
    }
    let text = format!("{value:.16e}");
    match text.split_once('e') {
        Some((digits, exponent)) => match exponent.strip_prefix('-') {
            Some(exponent) => format!("{digits}e-{exponent:0>2}"),
            None => format!("{digits}e+{exponent:0>2}"),
        },
        None => text,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn load(text: &str) -> Result<Camera> {
        decode(Path::new("a.yaml"), text.as_bytes())
    }

    #[test]
    fn numbers_are_those_of_opencv() {
        let found = [535.915_733_961_632, -2e-4, 0.0, 1.0].map(number);
        assert_eq!(
            found,
            ["5.3591573396163199e+02", "-2.0000000000000001e-04", "0.", "1.0000000000000000e+00"]
        );
    }

    #[test]
    fn a_sensor_of_euroc_is_read() {
        let text = "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n\
                    T_BS:\n  cols: 4\n  rows: 4\n  data: [0.0148655429818, -0.999880929698,\n         0.0, 1.0]\n\
                    rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n\
                    intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n\
                    distortion_model: radial-tangential\n\
                    distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";
        let lens = Lens::new(&[-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]).unwrap();
        let size = Size::new(752, 480);
        let camera = Camera { size, f_u: 458.654, f_v: 457.296, u_0: 367.215, v_0: 248.375, lens };
        assert_eq!(load(text).unwrap(), camera);
    }

    #[test]
    fn other_files_are_refused() {
        let error = |text: &str| load(text).unwrap_err().to_string();
        assert!(error("").starts_with("a.yaml: camera file is without a key, expected the YAML of OpenCV"));
        assert!(
            error("a: 1\nb:\n  c: 2\n").contains("one with the keys a, b"),
            "{}",
            error("a: 1\nb:\n  c: 2\n")
        );
        let text = decode(Path::new("a.png"), b"\x89PNG\r\n").unwrap_err().to_string();
        assert_eq!(text, "a.png: camera file is [89, 50, 4e, 47, 0d, 0a], expected text in UTF-8");
    }

    #[test]
    fn a_camera_that_cannot_be_is_refused_with_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swapped.yml");
        let lens = Lens::new(&[-0.266, -0.0386, 0.2384, 1.78e-3, -2.8e-4]).unwrap();
        let camera = from_intrinsics(Size::new(640, 480), [536.0, 536.0, 342.0, 235.0], lens);
        write(&path, &camera, Format::OpenCv).unwrap();
        let text = read(&path).unwrap_err().to_string();
        assert!(text.contains("swapped.yml: p1 is 0.2384, expected within ±0.05"), "{text}");
    }

    fn numbers() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0.0), -1e3..1e3, prop::num::f64::NORMAL]
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = decode(Path::new("a"), &bytes);
        }

        #[test]
        fn text_that_looks_like_it_never_panics(
            text in "((k|d|cam0|camera_matrix|data|intrinsics|resolution|- |é)?[: \\[\\]\\-#'\"!&{},.0-9e\n]{0,6}){0,30}",
        ) {
            let _ = load(&text);
        }

        #[test]
        fn a_file_that_is_cut_or_changed_never_panics(at in 0..600_usize, byte in any::<u8>()) {
            let lens = Lens::new(&[-0.28, 0.07, 2e-4, 2e-5]).unwrap();
            let camera = from_intrinsics(Size::new(640, 480), [536.0, 536.0, 342.0, 235.0], lens);
            for mut bytes in [opencv::encode(&camera), ros::encode(&camera), kalibr::encode(&camera).unwrap()] {
                let at = at % bytes.len();
                let _ = decode(Path::new("a"), &bytes[..at]);
                bytes[at] = byte;
                let _ = decode(Path::new("a"), &bytes);
            }
        }

        #[test]
        fn what_is_written_is_read_exactly(
            sides in (1..=16384_u32, 1..=16384_u32),
            intrinsics in prop::array::uniform4(numbers()),
            coefficients in prop::array::uniform8(numbers()),
            count in prop::sample::select(vec![0, 4, 5, 8]),
        ) {
            let lens = Lens::new(&coefficients[..count]).unwrap();
            let camera = from_intrinsics(Size::new(sides.0, sides.1), intrinsics, lens);
            let same = |bytes: &[u8]| decode(Path::new("a"), bytes).unwrap() == camera;
            prop_assert!(same(&opencv::encode(&camera)));
            prop_assert!(same(&ros::encode(&camera)));
            if let Ok(bytes) = kalibr::encode(&camera) {
                prop_assert!(same(&bytes));
            }
        }
    }
}
