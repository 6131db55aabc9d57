//! `viewsphere undistort` as its users run it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;
use viewsphere::camera::{Camera, Lens};
use viewsphere::frame::{Image, PixelFormat, Size};
use viewsphere::io::camera::{self, Format};
use viewsphere::io::picture;

use crate::need;

const SIZE: Size = Size::new(64, 48);

fn run(folder: &TempDir, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_viewsphere"))
        .arg("undistort")
        .args(args)
        .current_dir(folder.path())
        .env_remove("XDG_RUNTIME_DIR")
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

#[track_caller]
fn well(folder: &TempDir, args: &[&str]) -> String {
    let output = run(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[track_caller]
fn refused(folder: &TempDir, args: &[&str], words: &[&str]) {
    let names = |folder: &Path| fs::read_dir(folder).unwrap().count();
    let before = names(folder.path());
    let output = run(folder, args);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{args:?}: {stderr}");
    assert!(words.iter().all(|word| stderr.contains(word)), "{args:?}: {words:?} in {stderr}");
    assert_eq!(names(folder.path()), before, "{args:?}");
}

fn barrel() -> Camera {
    let lens = Lens::new(&[-0.3, 0.08, 1e-3, -5e-4]).unwrap();
    Camera { size: SIZE, f_u: 50.0, f_v: 51.0, u_0: 31.0, v_0: 24.5, lens }
}

/// The raw camera's image of a distant scene, a wave over directions: smooth, so that interpolation between pixels is
/// exact to a gray level.
fn shown(camera: &Camera, [u, v]: [f64; 2]) -> f64 {
    let ray = camera.ray([u, v]).unwrap();
    128.0 + 60.0 * (3.0 * ray.x / ray.z).sin() + 50.0 * (2.5 * ray.y / ray.z).cos()
}

fn photo(camera: &Camera, format: PixelFormat) -> Image {
    let mut data = Vec::new();
    for v in 0..camera.size.height {
        for u in 0..camera.size.width {
            let value = shown(camera, [f64::from(u), f64::from(v)]);
            match format {
                PixelFormat::Gray16 => data.extend(((257.0 * value) as u16).to_ne_bytes()),
                PixelFormat::Gray8 => data.push(value.round() as u8),
                _ => {
                    data.extend([value.round() as u8, 255 - value.round() as u8, 7, 200]);
                    data.truncate(data.len() - 4 + format.bytes());
                }
            }
        }
    }
    Image { size: camera.size, format, data }
}

/// A folder with a camera in each format, and images taken with it.
fn files() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (name, format) in
        [("cam.yml", Format::OpenCv), ("ros.yaml", Format::Ros), ("chain.yaml", Format::Kalibr)]
    {
        camera::write(at(name), &barrel(), format).unwrap();
    }
    for (name, format) in [
        ("gray.png", PixelFormat::Gray8),
        ("wide.png", PixelFormat::Gray16),
        ("rgb.png", PixelFormat::Rgb8),
        ("rgba.png", PixelFormat::Rgba8),
    ] {
        picture::write_png(at(name), &photo(&barrel(), format)).unwrap();
    }
    for number in 0..3 {
        picture::write_png(at(&format!("f{number}.png")), &photo(&barrel(), PixelFormat::Gray8)).unwrap();
    }
    let small = Camera { size: Size::new(32, 24), ..barrel() };
    camera::write(at("small.yml"), &small, Format::OpenCv).unwrap();
    let swapped = [-0.266, -0.0386, 0.2384, 1.78e-3, -2.8e-4];
    let swapped = Camera { lens: Lens::new(&swapped).unwrap(), ..barrel() };
    camera::write(at("swapped.yml"), &swapped, Format::OpenCv).unwrap();
    fs::write(at("other.yaml"), "a: 1\n").unwrap();
    folder
}

/// Compares a result with the image that its camera would take.
#[track_caller]
fn check(folder: &TempDir, picture: &str, camera: &str) {
    let image = picture::read(folder.path().join(picture)).unwrap();
    let out = camera::read(folder.path().join(camera)).unwrap();
    assert_eq!((image.size, out.lens), (out.size, Lens::NONE));
    let scale = if image.format == PixelFormat::Gray16 { 257.0 } else { 1.0 };
    let mut seen = 0;
    for v in 0..out.size.height {
        for u in 0..out.size.width {
            let pixel = [f64::from(u), f64::from(v)];
            let at = (v as usize * out.size.width as usize + u as usize) * image.format.bytes();
            let found = match image.format {
                PixelFormat::Gray16 => f64::from(u16::from_ne_bytes([image.data[at], image.data[at + 1]])),
                _ => f64::from(image.data[at]),
            };
            let place = barrel().place_of(&out, &glam::DMat3::IDENTITY, pixel);
            let beside = |[x, y]: [f64; 2], by: f64| {
                !((-by..=63.0 + by).contains(&x) && (-by..=47.0 + by).contains(&y))
            };
            match place {
                Some(place) if !beside(place, 0.0) => {
                    let expected = scale * shown(&out, pixel);
                    // Rounded twice, and a curve interpolated linearly.
                    assert!(
                        (found - expected).abs() <= 1.7 * scale,
                        "{picture} {pixel:?}: {found} {expected}"
                    );
                    seen += 1;
                }
                // Black starts a pixel further out.
                Some(place) if !beside(place, 1.0) => {}
                _ => assert!(found == 0.0, "{picture} {pixel:?}: {found} where nothing is shown"),
            }
        }
    }
    assert!(seen > out.size.pixels() / 2, "{seen}");
}

#[test]
fn pictures_of_every_kind_are_those_of_the_ideal_camera() {
    let folder = files();
    for (input, camera, view) in [
        ("gray.png", "cam.yml", &[][..]),
        ("wide.png", "ros.yaml", &["--crop"]),
        ("rgb.png", "chain.yaml", &["--keep-all", "--size", "90x70"]),
        ("rgba.png", "cam.yml", &["--keep-all"]),
    ] {
        let args =
            ["--camera", camera, input, "-o", "out.png", "--write-camera", "out.yaml", "--backend", "cpu"];
        let text = well(&folder, &[&args[..], view].concat());
        assert!(text.starts_with("camera  "), "{text}");
        assert_eq!(text.contains("100.00 %"), !view.contains(&"--keep-all"), "{text}");
        check(&folder, "out.png", "out.yaml");
        let format = |name: &str| picture::read(folder.path().join(name)).unwrap().format;
        assert_eq!(format("out.png"), format(input));
    }
}

#[test]
fn the_gpu_writes_the_same_pictures() {
    if need::gpu().is_none() {
        return;
    }
    let folder = files();
    for backend in ["cpu", "gpu"] {
        let output = format!("{backend}.png");
        well(&folder, &["--camera", "cam.yml", "rgb.png", "-o", &output, "--backend", backend]);
    }
    let [cpu, gpu] = ["cpu.png", "gpu.png"].map(|name| picture::read(folder.path().join(name)).unwrap());
    assert_eq!(cpu.size, gpu.size);
    // A position that differs by a thousandth of a pixel may round to the next level.
    assert!(cpu.data.iter().zip(&gpu.data).all(|(a, b)| a.abs_diff(*b) <= 1));
}

#[test]
fn a_sequence_becomes_a_folder_and_one_picture_may_go_to_standard_output() {
    let folder = files();
    well(&folder, &["--camera", "cam.yml", "f%d.png", "-o", "out", "--backend", "cpu"]);
    let first = fs::read(folder.path().join("out/000000.png")).unwrap();
    for number in 1..3 {
        assert_eq!(fs::read(folder.path().join(format!("out/{number:06}.png"))).unwrap(), first);
    }
    let stdout = run(&folder, &["--camera", "cam.yml", "f0.png", "-o", "-", "--backend", "cpu"]).stdout;
    assert_eq!(stdout, first);
}

#[test]
fn the_field_is_drawn_over_the_picture() {
    let folder = files();
    assert_eq!(well(&folder, &["--camera", "cam.yml", "gray.png", "--field", "field.png"]), "");
    let image = picture::read(folder.path().join("field.png")).unwrap();
    assert_eq!((image.size, image.format), (SIZE, PixelFormat::Rgb8));
    let coloured = image.data.chunks_exact(3).filter(|p| p[0] != p[1]).count();
    assert!(coloured > 50, "{coloured}");
}

#[test]
fn each_format_of_the_new_camera_says_the_same() {
    let folder = files();
    let read = |name: &str| camera::read(folder.path().join(name)).unwrap();
    for format in ["opencv", "ros", "kalibr"] {
        let name = format!("{format}.yaml");
        let args = ["--camera", "cam.yml", "gray.png", "--crop", "--write-camera", &name];
        well(&folder, &[&args[..], &["--camera-format", format]].concat());
        assert_eq!(read(&name), read("opencv.yaml"));
    }
}

#[test]
fn no_input_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    camera::write(path("cam.yaml"), &barrel(), Format::OpenCv).unwrap();
    let image = Image { size: SIZE, format: PixelFormat::Gray8, data: vec![90; SIZE.pixels()] };
    picture::write_png(path("000000.png"), &image).unwrap();
    let before = [fs::read(path("cam.yaml")).unwrap(), fs::read(path("000000.png")).unwrap()];
    let expected = "expected a path other than that of the input";
    refused(&folder, &["--camera", "cam.yaml", "000000.png", "-o", "./000000.png"], &["-o is", expected]);
    refused(&folder, &["--camera", "cam.yaml", "*.png", "-o", "."], &["-o is .,", expected]);
    let camera = ["--camera", "cam.yaml", "000000.png", "--write-camera", "cam.yaml"];
    refused(&folder, &camera, &["--write-camera is cam.yaml", expected]);
    assert_eq!(before, [fs::read(path("cam.yaml")).unwrap(), fs::read(path("000000.png")).unwrap()]);
}

#[test]
fn bad_input_is_named() {
    let folder = files();
    for (args, words) in [
        (&["--camera", "no.yml", "gray.png", "-o", "o.png"][..], &["no.yml"][..]),
        (&["--camera", "other.yaml", "gray.png", "-o", "o.png"], &["other.yaml", "keys a", "camera_matrix"]),
        (&["--camera", "gray.png", "gray.png", "-o", "o.png"], &["gray.png", "UTF-8"]),
        (&["--camera", "swapped.yml", "gray.png", "-o", "o.png"], &["swapped.yml", "p1 is 0.2384"]),
        (
            &["--camera", "small.yml", "gray.png", "-o", "o.png"],
            &["gray.png", "64×48", "32×24 as in small.yml"],
        ),
        (&["--camera", "cam.yml", "no.png", "-o", "o.png"], &["no.png"]),
        (&["--camera", "cam.yml", "gray.png"], &["-o is missing", "--field"]),
        (&["--camera", "cam.yml", "gray.png", "-o", "o.jpg"], &["o.jpg", ".png"]),
        (&["--camera", "cam.yml", "gray.png", "-o", "no/o.png"], &["no"]),
        (&["--camera", "cam.yml", "f%d.png", "-o", "o.png"], &["o.png", "a folder"]),
        (
            &["--camera", "cam.yml", "gray.png", "--field", "o.png", "-o", "o.png"],
            &["--field is o.png,", "that of -o"],
        ),
        (&["--camera", "cam.yml", "gray.png", "--field", "-"], &["--field is -"]),
        (&["--camera", "cam.yml", "gray.png", "--write-camera", "o.txt"], &["o.txt", ".yaml or .yml"]),
        (
            &["--camera", "cam.yml", "gray.png", "-o", "o.png", "--crop", "--keep-all"],
            &["--crop", "--keep-all"],
        ),
        (&["--camera", "cam.yml", "gray.png", "-o", "o.png", "--size", "0x5"], &["0x5"]),
        (&["--camera", "cam.yml", "gray.png", "-o", "o.png", "--raw", "4x4"], &["--raw"]),
        (&["--camera", "cam.yml", "-", "-o", "o"], &["standard input", "empty"]),
        (&["gray.png", "-o", "o.png"], &["--camera"]),
    ] {
        refused(&folder, args, words);
    }
}
