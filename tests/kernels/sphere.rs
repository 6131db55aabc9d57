//! The kernels on the view sphere against the formulas in `f64`.

use glam::{DMat3, DVec3};
use viewsphere::frame::Size;
use viewsphere::gpu::Gpu;
use viewsphere::kernel::Kernel;
use viewsphere::kernels::cells::CHANNELS;
use viewsphere::kernels::{looming, rotational_flow, spherical_flow};
use viewsphere::sphere::{Heading, Motion, model};

use crate::need;

const SIZE: Size = Size::new(320, 240);
/// A focal length at which the corners lie 75 degrees off the axis.
const FOCAL: f64 = 53.0;

/// Runs a kernel of the sphere on the CPU, and on the GPU if there is one.
fn run(kernel: &Kernel, params: &[u8], inputs: &[&[f32]], size: Size, channels: usize) -> Vec<Vec<f32>> {
    let len = channels * size.stride() * size.height as usize;
    let mut reference = vec![f32::NAN; len];
    (kernel.reference)(params, inputs, &mut [&mut reference]);
    let on_gpu = |gpu: Gpu| {
        let run = gpu.run_kernel(kernel, params, inputs, &[len], [size.width, size.height]);
        run.unwrap_or_else(|error| panic!("{error}")).remove(0)
    };
    std::iter::once(reference).chain(need::gpu_if_any().map(on_gpu)).collect()
}

fn pinhole() -> spherical_flow::Params {
    spherical_flow::Params {
        width: SIZE.width,
        height: SIZE.height,
        focal: [FOCAL as f32; 2],
        centre: [159.5, 119.5],
    }
}

fn ray(x: f64, y: f64) -> DVec3 {
    DVec3::new((x - 159.5) / FOCAL, (y - 119.5) / FOCAL, 1.0)
}

/// The displacement of every pixel back to the previous frame, in a world of points at these distances, and the
/// bearings.
fn world(prev_from_cur: DMat3, moved: DVec3) -> (Vec<f32>, Vec<[DVec3; 2]>) {
    let stride = SIZE.stride();
    let mut flow = vec![0.0; 2 * stride * SIZE.height as usize];
    let mut bearings = Vec::new();
    for y in 0..SIZE.height as usize {
        for x in 0..SIZE.width as usize {
            let current = ray(x as f64, y as f64);
            let point = current.normalize() * (6.0 + ((x * 7 + y * 13) % 40) as f64);
            let before = prev_from_cur * (point + moved);
            let place = before / before.z * FOCAL;
            flow[2 * y * stride + x] = (place.x + 159.5 - x as f64) as f32;
            flow[(2 * y + 1) * stride + x] = (place.y + 119.5 - y as f64) as f32;
            // The bearing in the previous camera, rotated like the current one.
            bearings.push([(point + moved).normalize(), current.normalize()]);
        }
    }
    (flow, bearings)
}

#[test]
fn the_spherical_flow_is_that_of_the_moved_points() {
    // 30 m/s and a roll of 150 degrees a second, at 30 frames a second.
    let prev_from_cur =
        DMat3::from_rotation_z(-5f64.to_radians()) * DMat3::from_rotation_y(2f64.to_radians());
    let (flow, bearings) = world(prev_from_cur, DVec3::new(0.1, -0.05, 1.0));
    let motion = Motion { prev_from_cur, heading: Heading::UNKNOWN }.values();
    let stride = SIZE.stride();
    for found in run(&spherical_flow::KERNEL, bytemuck::bytes_of(&pinhole()), &[&flow, &motion], SIZE, 3) {
        let mut largest: f64 = 0.0;
        let mut behind = 0;
        for (i, [before, now]) in bearings.iter().enumerate() {
            let (x, y) = (i % SIZE.width as usize, i / SIZE.width as usize);
            // A place almost beside the camera is thousands of pixels away, where f32 has too few digits.
            if (prev_from_cur * *before).z < 0.2 {
                behind += 1;
                continue;
            }
            let at = |channel: usize| f64::from(found[(3 * y + channel) * stride + x]);
            let (_, expected) = model::midpoint_flow(*before, *now);
            let error = (DVec3::new(at(0), at(1), at(2)) - expected).length() / expected.length();
            largest = largest.max(error);
        }
        // 1e-4 of the flow, which is at least a hundredth of a radian here.
        assert!(largest <= 1e-4, "{largest}");
        assert!(behind < 2000, "{behind} of {} left out", bearings.len());
    }
}

#[test]
fn a_turn_alone_leaves_nothing() {
    let prev_from_cur = DMat3::from_rotation_x(0.03) * DMat3::from_rotation_z(0.08);
    let motion = Motion { prev_from_cur, heading: Heading::UNKNOWN }.values();
    for flow in run(&rotational_flow::KERNEL, bytemuck::bytes_of(&pinhole()), &[&motion], SIZE, 2) {
        for found in run(&spherical_flow::KERNEL, bytemuck::bytes_of(&pinhole()), &[&flow, &motion], SIZE, 3)
        {
            // A pixel is up to 1/53 of a radian.
            let largest = found.iter().fold(0.0, |largest: f32, value| largest.max(value.abs()));
            assert!(largest < 2e-6, "{largest}");
        }
        // The rotation is a large one: the corners move by some ten pixels.
        let longest = flow.iter().fold(0.0, |longest: f32, value| longest.max(value.abs()));
        assert!(longest > 10.0, "{longest}");
    }
}

/// Largest errors of the divergence and of the nearness rate over cells this far apart, relative to their values
/// straight ahead, in front of a slanted plane. On every executor.
fn errors_of_cells(pitch: f64) -> Vec<[f64; 2]> {
    // 50 degrees off the axis at the corners, whatever the pitch.
    let side = (1.6 / pitch) as u32;
    let size = Size::new(side, side);
    let (normal, distance, v) = (DVec3::new(0.4, -0.2, 0.9).normalize(), 40.0, DVec3::new(0.05, 0.02, 0.33));
    let place = |x: u32, y: u32| [x, y].map(|i| pitch * (f64::from(i) - 0.5 * f64::from(side - 1)));
    let stride = size.stride();
    let mut cells = vec![0.0; CHANNELS * stride * side as usize];
    for (y, rows) in (0..).zip(cells.chunks_exact_mut(CHANNELS * stride)) {
        for x in 0..stride {
            let at = place((x as u32).min(side - 1), y);
            let p = DVec3::new(at[0], at[1], 1.0).normalize();
            let rate = model::to_plane(p, model::bearing_rate(p, normal.dot(p) / distance, v, DVec3::ZERO));
            for (channel, value) in [1.0, at[0], at[1], rate[0], rate[1], 1.0].into_iter().enumerate() {
                rows[channel * stride + x] = value as f32;
            }
        }
    }
    let first = place(0, 0).map(|value| value as f32);
    let params = looming::Params {
        columns: side,
        rows: side,
        radius: 2,
        inner: 1,
        pitch: [pitch as f32; 2],
        origin: first,
        noise: 1e-5,
        least_confidence: 0.2,
    };
    let heading = Heading { direction: v.normalize(), error_rad: 1e-3 };
    let motion = Motion { prev_from_cur: DMat3::IDENTITY, heading }.values();
    let ahead = v.length() * normal.dot(DVec3::Z) / distance;
    let worst = |found: Vec<f32>| {
        let mut worst = [0.0_f64; 2];
        for y in 2..side - 2 {
            for x in 2..side - 2 {
                let at = place(x, y);
                let p = DVec3::new(at[0], at[1], 1.0).normalize();
                let nearness = normal.dot(p) / distance;
                let gradient = (normal - p * normal.dot(p)) / distance;
                let expected = [nearness * v.length(), model::divergence(p, nearness, gradient, v)];
                for (channel, (worst, expected)) in worst.iter_mut().zip(expected).enumerate() {
                    let value = f64::from(found[(4 * y as usize + channel) * stride + x as usize]);
                    *worst = worst.max((value - expected).abs() / ahead);
                }
            }
        }
        [worst[1], worst[0]]
    };
    let run = run(&looming::KERNEL, bytemuck::bytes_of(&params), &[&cells, &motion], size, 4);
    run.into_iter().map(worst).collect()
}

#[test]
fn the_divergence_is_of_second_order_and_the_nearness_rate_exact_enough() {
    let (coarse, fine) = (errors_of_cells(0.0534), errors_of_cells(0.0267));
    for ([divergence, nearness], [fine_divergence, fine_nearness]) in coarse.into_iter().zip(fine) {
        println!("16 px: {divergence:.5} {nearness:.5}; 8 px: {fine_divergence:.5} {fine_nearness:.5}");
        let order = divergence / fine_divergence;
        assert!((3.0..5.5).contains(&order) && fine_divergence < 2e-3, "{divergence} {fine_divergence}");
        assert!(nearness < 0.03 && fine_nearness < 0.01, "{nearness} {fine_nearness}");
    }
}
