//! Derotation by the gyro of a real flight, compared with its true poses; needs the data set `euroc_v101`.

use std::path::Path;

use glam::{DMat3, DQuat, DVec3};
use viewsphere::flow::Farneback;
use viewsphere::imu::GyroConfig;
use viewsphere::io::{camera, gyro_log, picture};
use viewsphere::sphere::{Derotation, ExtraOutputs, Sphere};
use viewsphere::{Backend, Pipeline, PipelineConfig};

use crate::data;
use crate::quantile::quantile;

/// The camera in the body's frame (`T_BS` of cam0): rotation, row by row, and place in metres.
const BODY_FROM_CAMERA: [[f64; 4]; 3] = [
    [0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975],
    [0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768],
    [-0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949],
];

fn extrinsics() -> (DMat3, DVec3) {
    let rows = BODY_FROM_CAMERA.map(|row| DVec3::new(row[0], row[1], row[2]));
    let place = DVec3::from_array(BODY_FROM_CAMERA.map(|row| row[3]));
    (DMat3::from_cols(rows[0], rows[1], rows[2]).transpose(), place)
}

/// Time, the camera's place in the world, its attitude, and the gyro's bias.
struct Truth {
    time_s: f64,
    place: DVec3,
    world_from_camera: DMat3,
    bias: DVec3,
}

fn truth(folder: &Path) -> Vec<Truth> {
    let text = std::fs::read_to_string(folder.join("derived_groundtruth_slice.csv"))
        .unwrap_or_else(|error| panic!("{error}"));
    let (body_from_camera, lever) = extrinsics();
    let row = |line: &str| {
        let v: Vec<f64> = line.split(',').filter_map(|field| field.parse().ok()).collect();
        let world_from_body = DMat3::from_quat(DQuat::from_xyzw(v[5], v[6], v[7], v[4]).normalize());
        Truth {
            time_s: v[0] * 1e-9,
            place: DVec3::new(v[1], v[2], v[3]) + world_from_body * lever,
            world_from_camera: world_from_body * body_from_camera,
            bias: DVec3::new(v[11], v[12], v[13]),
        }
    };
    text.lines().skip(1).map(row).collect()
}

/// The median angle between derotated rays and their epipolar planes over a flight's confident pixels, in degrees.
fn median_deg(folder: &Path, derotation: Derotation, bias: Option<DVec3>) -> f64 {
    let truth = truth(folder);
    let (body_from_camera, _) = extrinsics();
    let camera = camera::read(folder.join("cam0_sensor.yaml")).unwrap_or_else(|error| panic!("{error}"));
    let config = PipelineConfig {
        algorithm: Farneback::accurate().into(),
        sphere: Sphere { derotation, ..Sphere::default() },
        gyro: Some(GyroConfig {
            bias_rad_s: bias.unwrap_or(truth[0].bias),
            camera_from_gyro: body_from_camera.transpose(),
            ..GyroConfig::default()
        }),
        fields: ExtraOutputs { looming: true, spherical_flow: true, ..ExtraOutputs::default() },
        ..PipelineConfig::default()
    };
    let mut pipeline =
        Pipeline::new(Backend::Cpu, &camera, &config).unwrap_or_else(|error| panic!("{error}"));
    let log = gyro_log::read(folder.join("derived_imu0_slice.csv")).unwrap_or_else(|error| panic!("{error}"));
    log.into_iter().for_each(|sample| pipeline.push_gyro(sample));
    let mut files: Vec<_> = std::fs::read_dir(folder.join("cam0"))
        .unwrap_or_else(|error| panic!("{error}"))
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    files.sort();
    let mut angles = Vec::new();
    let mut before: Option<usize> = None;
    for file in files {
        let nanoseconds: f64 =
            file.file_stem().and_then(|stem| stem.to_str()?.parse().ok()).unwrap_or(f64::NAN);
        let time_s = nanoseconds * 1e-9;
        let at = truth.iter().position(|truth| (truth.time_s - time_s).abs() < 1e-4);
        let image = picture::read(&file).unwrap_or_else(|error| panic!("{error}"));
        let frame = image.frame().unwrap_or_else(|error| panic!("{error}"));
        let ideal = *pipeline.ideal();
        let stride = ideal.size.stride();
        let cells = pipeline.cells().size;
        let cue = pipeline.process(&frame, time_s).unwrap_or_else(|error| panic!("{error}"));
        if let (Some(now), Some(then), Some((looming, spherical_flow))) =
            (at, before, cue.looming.zip(cue.spherical_flow))
        {
            assert_eq!(cue.invalid, None);
            let step = truth[now].world_from_camera.transpose() * (truth[now].place - truth[then].place);
            for y in (0..ideal.size.height as usize).step_by(3) {
                for x in (0..ideal.size.width as usize).step_by(3) {
                    let confidence = looming[(4 * (y / 8) + 3) * cells.stride() + x / 8];
                    let Some(p) = ideal.ray([x as f64, y as f64]).filter(|_| confidence >= 0.3) else {
                        continue;
                    };
                    let flow = DVec3::from_array(
                        [0, 1, 2].map(|channel| f64::from(spherical_flow[(3 * y + channel) * stride + x])),
                    );
                    let normal = p.cross(step).normalize();
                    angles.push((p - flow).normalize().dot(normal).abs().asin().to_degrees());
                }
            }
        }
        before = at;
    }
    assert!(angles.len() > 30_000, "{} rays", angles.len());
    quantile(&mut angles, 0.5)
}

#[test]
fn derotated_rays_stay_in_their_epipolar_planes() {
    let Some(folder) = data::set("euroc_v101") else { return };
    for derotation in [Derotation::Before, Derotation::After, Derotation::Primed] {
        let median = median_deg(&folder, derotation, None);
        println!("{derotation:?}: {median:.4}°");
        assert!(median <= 0.05, "{derotation:?}: {median}");
    }
    // With a bias of two degrees per second the rays leave their planes.
    let wrong = median_deg(&folder, Derotation::Before, Some(DVec3::new(0.035, 0.035, 0.0)));
    println!("wrong gyro: {wrong:.4}°");
    assert!(wrong > 0.05, "{wrong}");
}
