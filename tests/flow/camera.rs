//! Cameras compared with OpenCV's results, and the maps of the kernels compared with those in `f64`.

use std::fs;
use std::path::Path;

use glam::{DMat3, DVec3};
use viewsphere::camera::{Camera, Lens, world_from_body};
use viewsphere::frame::{PixelFormat, Size};
use viewsphere::io::picture;
use viewsphere::kernels::{remap, undistort_map};

use crate::data;

/// OpenCV 4.13's rational calibration of a wide GoPro. Its denominator has a root 58° from the axis, inside the image,
/// so that no file with it is accepted. Up to there its values can be compared.
fn gopro() -> Camera {
    let lens = [
        -0.06174823299398439,
        -0.12408631387200789,
        -0.00033528942667309,
        7.638596112468958e-05,
        -0.0013080958818334641,
        0.2055950597498576,
        -0.19424975579753015,
        -0.014509821542011126,
    ];
    Camera {
        size: Size::new(1280, 960),
        f_u: 567.2903401319561,
        f_v: 568.0479626551577,
        u_0: 650.0017466025795,
        v_0: 500.33323299562414,
        lens: Lens::new(&lens).unwrap(),
    }
}

/// OpenCV's view of it without empty borders (`alpha` of 0).
fn cropped() -> Camera {
    let (f_u, f_v, u_0, v_0) = (366.711644093, 455.082475999, 661.280177693, 509.805777646);
    Camera { size: Size::new(1280, 960), f_u, f_v, u_0, v_0, lens: Lens::NONE }
}

/// The numbers of a table, without its comments and its heading.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let numbers = |line: &str| line.split(',').map(|n| n.parse().ok()).collect::<Option<Vec<f64>>>();
    text.lines().filter_map(numbers).collect()
}

#[test]
fn rays_are_those_of_opencv() {
    let Some(folder) = data::set("golden_cv2") else { return };
    let (camera, limit) = (gopro(), gopro().lens.radius_limit());
    let (mut worst, mut seen, mut hidden) = (0.0_f64, 0, 0);
    for row in rows(&folder.join("gopro_undistort_points.csv")) {
        let [u, v, x, y, r_x, r_y, r_z, _] = row[..] else { panic!("{row:?}") };
        let ray = camera.ray([u, v]);
        // Just before the root the image is stretched without bound; beyond it OpenCV continues, with a numerator and a
        // denominator below 0.
        if x.hypot(y) > limit {
            assert_eq!(ray, None, "{u} {v}");
            hidden += 1;
            continue;
        }
        let ray = ray.unwrap();
        worst = worst.max((ray - DVec3::new(r_x, r_y, r_z)).length());
        worst = worst.max((ray / ray.z - DVec3::new(x, y, 1.0)).length());
        let back = camera.project(ray).unwrap();
        assert!((back[0] - u).hypot(back[1] - v) <= 1e-9, "{u} {v} {back:?}");
        seen += 1;
    }
    println!("{seen} rays, {hidden} beyond the root, worst {worst:e}");
    // The table has twelve digits.
    assert!(worst <= 1e-6, "{worst:e}");
    assert_eq!((seen, hidden), (95, 26));
}

#[test]
fn the_map_is_that_of_opencv() {
    let Some(folder) = data::set("golden_cv2") else { return };
    let (raw, out) = (gopro(), cropped());
    let mut worst = 0.0_f64;
    let (mut seen, mut count) = (0, 0);
    for row in rows(&folder.join("gopro_undistort_map.csv")) {
        let [u, v, map_x, map_y] = row[..] else { panic!("{row:?}") };
        let ray = out.ray([u, v]).unwrap();
        // The formula alone, which OpenCV follows beyond the root as well.
        let [x, y] = raw.lens.distort([ray.x / ray.z, ray.y / ray.z]);
        let place = [raw.f_u * x + raw.u_0, raw.f_v * y + raw.v_0];
        worst = worst.max((place[0] - map_x).hypot(place[1] - map_y));
        if let Some(same) = raw.place_of(&out, &DMat3::IDENTITY, [u, v]) {
            assert!((place[0] - same[0]).hypot(place[1] - same[1]) <= 1e-9);
            seen += 1;
        }
        count += 1;
    }
    println!("{count} places, {seen} before the root, worst {worst:e} px");
    // OpenCV's map is in f32: 4e-5 px at 1000 px, and the table is rounded to 1e-5.
    assert!(worst <= 1e-4, "{worst:e}");
    assert_eq!((seen, count), (84, 100));
}

/// The map and the certainty of `out` in `raw`, by the kernel's reference.
fn mapped(raw: &Camera, out: &Camera, raw_from_out: &DMat3) -> (Vec<f32>, Vec<f32>) {
    let params = undistort_map::Params::new(out, raw);
    let mask = vec![1.0; raw.size.stride() * raw.size.height as usize];
    let row = out.size.stride() * out.size.height as usize;
    let (mut map, mut certainty) = (vec![f32::NAN; 2 * row], vec![f32::NAN; row]);
    (undistort_map::KERNEL.reference)(
        bytemuck::bytes_of(&params),
        &[&undistort_map::motion(raw_from_out), &mask],
        &mut [&mut map, &mut certainty],
    );
    (map, certainty)
}

#[test]
fn the_undistorted_picture_is_that_of_opencv() {
    let (Some(golden), Some(photo)) = (data::set("golden_cv2"), data::set("udacity_gopro_wide")) else {
        return;
    };
    let (raw, out) = (gopro(), cropped());
    let expected = picture::read(golden.join("gopro_test_image_undistorted_gray.png")).unwrap();
    let source = picture::read(photo.join("test_image.jpg")).unwrap();
    assert_eq!((expected.size, expected.format, source.size), (out.size, PixelFormat::Gray8, raw.size));
    // OpenCV's weights when it reads a JPEG in gray.
    let gray = |rgb: &[u8]| {
        let [r, g, b] = [rgb[0], rgb[1], rgb[2]].map(f32::from);
        (0.299 * r + 0.587 * g + 0.114 * b).round()
    };
    let values: Vec<f32> = match source.format {
        PixelFormat::Gray8 => source.data.iter().map(|v| f32::from(*v)).collect(),
        _ => source.data.chunks_exact(source.format.bytes()).map(gray).collect(),
    };
    let (map, certainty) = mapped(&raw, &out, &DMat3::IDENTITY);
    let params = remap::Params { width: 1280, height: 960, in_width: 1280, in_height: 960 };
    let histogram = |map: &[f32]| {
        let mut found = vec![f32::NAN; values.len()];
        (remap::KERNEL.reference)(bytemuck::bytes_of(&params), &[&values, map], &mut [&mut found]);
        let mut histogram = [0_usize; 256];
        let seen = found.iter().zip(&expected.data).zip(&certainty).filter(|(_, c)| **c >= 1.0);
        for ((found, expected), _) in seen {
            histogram[(found.round() - f32::from(*expected)).abs() as usize] += 1;
        }
        histogram
    };
    let exact = histogram(&map);
    let count: usize = exact.iter().sum();
    println!("{count} of {} pixels, differences of 0, 1, 2, … gray levels: {:?}", values.len(), &exact[..8]);
    assert!(count > 1_000_000 && exact[0] * 100 > 97 * count, "{:?}", &exact[..8]);
    assert!(exact[2] * 1000 <= count && exact[3..].iter().all(|n| *n == 0), "{:?}", &exact[..8]);
    // Single gray levels differ by one more because OpenCV rounds places to 1/32 px: at its places none does.
    let mut rounded = map;
    for (v, rows) in rounded.chunks_exact_mut(2 * 1280).enumerate() {
        for u in 0..1280 {
            // In `f64`, as OpenCV computes them: a ten-thousandth of a pixel decides the rounding of some.
            let place = raw.place_of(&out, &DMat3::IDENTITY, [u as f64, v as f64]);
            let Some(place) = place else { continue };
            for (channel, place) in place.into_iter().enumerate() {
                rows[1280 * channel + u] = (32.0 * place as f32).round_ties_even() / 32.0;
            }
        }
    }
    let rounded = histogram(&rounded);
    println!("read at OpenCV's places: {:?}", &rounded[..8]);
    assert!(rounded[0] * 100 > 99 * count && rounded[2..].iter().all(|n| *n == 0), "{:?}", &rounded[..8]);
}

#[test]
fn files_that_tools_have_written_are_read() {
    let (Some(chessboard), Some(euroc)) = (data::set("opencv_chessboard"), data::set("euroc_v101")) else {
        return;
    };
    let camera = viewsphere::io::camera::read(chessboard.join("left_intrinsics.yml")).unwrap();
    assert_eq!((camera.size, camera.f_u), (Size::new(640, 480), 535.915733961632));
    assert_eq!(camera.lens.coefficients[4], 0.23839153080878486);
    for (name, f_u) in [("cam0", 458.654), ("cam1", 457.587)] {
        let camera = viewsphere::io::camera::read(euroc.join(format!("{name}_sensor.yaml"))).unwrap();
        assert_eq!((camera.size, camera.f_u), (Size::new(752, 480), f_u));
    }
}

#[test]
fn the_kernel_maps_as_f64_does() {
    let size = Size::new(641, 363);
    let camera = |f: f64, lens: &[f64]| Camera {
        size,
        f_u: f,
        f_v: 1.02 * f,
        u_0: 317.3,
        v_0: 185.1,
        lens: Lens::new(lens).unwrap(),
    };
    let ideal = camera(300.0, &[]);
    let mut worst = 0.0_f64;
    for lens in [
        &[][..],
        &[-0.28, 0.07, 2e-4, 2e-5],
        &[-0.3, -0.02, 2e-3, -1e-3, -0.01],
        &[0.25, 0.01, -3e-4, 8e-5, 0.002, 0.6, 0.08, 0.006],
    ] {
        let raw = camera(330.0, lens);
        for [roll, pitch, yaw] in [[0.0, 0.0, 0.0], [0.3, -0.1, 0.2], [0.0, 2.0, 0.0]] {
            let rotation = world_from_body(roll, pitch, yaw);
            let (map, certainty) = mapped(&raw, &ideal, &rotation);
            let stride = size.stride();
            for v in 0..363 {
                for u in 0..641 {
                    let pixel = [u as f64, v as f64];
                    let certainty = certainty[v * stride + u];
                    assert!((0.0..=1.0).contains(&certainty));
                    let found = [map[2 * v * stride + u], map[(2 * v + 1) * stride + u]].map(f64::from);
                    assert!((0.0..=640.0).contains(&found[0]) && (0.0..=362.0).contains(&found[1]));
                    let place = raw.place_of(&ideal, &rotation, pixel);
                    let inside = |p: &[f64; 2]| {
                        let edge = 1e-3;
                        (edge..640.0 - edge).contains(&p[0]) && (edge..362.0 - edge).contains(&p[1])
                    };
                    let Some(place) = place.filter(inside) else {
                        // The certainty fades over one pixel around the frame; rounding gets a thousandth.
                        let near = place.is_some_and(|p| {
                            (-1.01..641.01).contains(&p[0]) && (-1.01..363.01).contains(&p[1])
                        });
                        assert!(near || certainty <= 1e-3, "{pixel:?} {place:?} {certainty}");
                        continue;
                    };
                    let difference = (found[0] - place[0]).hypot(found[1] - place[1]);
                    worst = worst.max(difference);
                }
            }
        }
    }
    println!("largest difference {worst:e} px");
    // Half the allowed difference of the kernel's two sides.
    assert!(worst <= 5e-4, "{worst:e}");
}
