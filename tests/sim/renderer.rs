//! The renderer's kernels, compared with the renderer in double precision and with the ground truth.

use glam::{DMat3, DVec3};
use viewsphere::camera::{Camera, FRD_FROM_CAMERA, Lens, Pose, world_from_body};
use viewsphere::frame::{FlowField, Size};
use viewsphere::sim::{
    CourseKind, RayTable, Renderer, RendererConfig, Surface, World, displacement, reference_render, scenes,
};
use viewsphere::{Backend, Error};

use crate::need;
use crate::sample::sample;

const SIZE: Size = Size::new(320, 240);
const BARREL: [f64; 4] = [-0.28, 0.07, 2e-4, 2e-5];
const CLEAN: RendererConfig = RendererConfig { noise_levels: 0.0, blur_poses: 1, range_m: f64::INFINITY };

fn camera(size: Size) -> Camera {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let (f, lens) = (0.6 * width, Lens::new(&BARREL).unwrap());
    Camera { size, f_u: f, f_v: f, u_0: (width - 1.0) / 2.0, v_0: (height - 1.0) / 2.0, lens }
}

/// A pose in NED that looks along the body's x.
fn flying(position_ned_m: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    Pose {
        position_world: DVec3::from(position_ned_m),
        world_from_camera: world_from_body(roll, pitch, yaw) * FRD_FROM_CAMERA,
    }
}

/// Two poses of a flight at 12 m/s, a thirtieth of a second apart.
fn flight(position: [f64; 3], turn: [f64; 3]) -> [Pose; 2] {
    let next = [position[0] + 0.4, position[1] + 0.02, position[2] - 0.01];
    [flying(position, turn), flying(next, [turn[0] + 0.02, turn[1] - 0.004, turn[2] + 0.01])]
}

fn worlds() -> Vec<(&'static str, World, [Pose; 2])> {
    let course = |text: &str| text.parse::<CourseKind>().unwrap().course(3).unwrap().world;
    let still = |step: f64| Pose {
        position_world: DVec3::new(0.11, -0.07, 0.3) * step,
        world_from_camera: DMat3::from_rotation_y(0.06 * step) * DMat3::from_rotation_z(0.05 * step),
    };
    let mut worlds = vec![
        ("wall", scenes::oblique_wall(5.0, 0.8).unwrap(), [0.2, 0.45].map(still)),
        ("corridor", scenes::corridor(20.0).unwrap(), [0.2, 0.45].map(still)),
        ("yard", scenes::yard(6.0).unwrap(), [0.2, 0.45].map(still)),
        ("forest", course("forest:density=1/100"), flight([30.0, 1.0, -8.0], [0.3, -0.05, 0.1])),
        ("city", course("city"), flight([60.0, 2.0, -12.0], [-0.2, 0.05, -0.1])),
    ];
    // Far from the origin, where single precision has a step of a millimetre.
    let far = DVec3::new(9000.0, -7000.0, -30.0);
    let surfaces = vec![
        Surface::plane(far + DVec3::Z * 3.0, DVec3::NEG_Z).unwrap(),
        Surface::rectangle(far + DVec3::X * 12.0, DVec3::Y * 7.0, DVec3::NEG_Z * 2.0).unwrap(),
        Surface::cylinder(far + DVec3::new(6.0, -2.0, 3.0), far + DVec3::new(6.0, -2.5, -6.0), 0.4).unwrap(),
    ];
    let at = |x: f64| flying((far + DVec3::X * x).to_array(), [0.1, 0.0, 0.05 * x]);
    worlds.push(("far from the origin", World { surfaces, up_world: DVec3::NEG_Z }, [at(0.0), at(0.2)]));
    worlds
}

fn backends() -> Vec<Backend> {
    let gpu = need::gpu_if_any().map(Backend::Gpu);
    std::iter::once(Backend::Cpu).chain(gpu).collect()
}

fn renderer(backend: &Backend, size: Size, world: &World, config: &RendererConfig) -> Renderer {
    Renderer::new(backend.clone(), &camera(size), world, config).unwrap()
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share) as usize]
}

/// Pixels around which a single smooth surface is visible.
fn smooth(nearness: &[f32], width: usize) -> impl Fn(usize) -> bool {
    move |i: usize| {
        let (x, y) = (i % width, i / width);
        let height = nearness.len() / width;
        if x < 2 || y < 2 || x + 2 >= width || y + 2 >= height {
            return false;
        }
        let around = |step: usize| {
            let bend = nearness[i - step] + nearness[i + step] - 2.0 * nearness[i];
            bend.abs() <= 0.02 * nearness[i].max(1e-3)
        };
        around(1) && around(2) && around(width) && around(2 * width)
    }
}

#[test]
fn pictures_are_those_of_the_renderer_in_double_precision() {
    let rays = RayTable::new(&camera(SIZE)).unwrap();
    for (name, world, [pose, _]) in worlds() {
        let expected = reference_render(&world, &rays, &pose);
        let is_smooth = smooth(&expected.nearness_per_m.data, 320);
        for backend in backends() {
            let mut renderer = renderer(&backend, SIZE, &world, &CLEAN);
            let image = renderer.render(&pose, 0).unwrap().clone();
            let off = |i: usize| f64::from(image.data[i].abs_diff(expected.image.data[i]));
            let mut inside: Vec<f64> = (0..SIZE.pixels()).filter(|i| is_smooth(*i)).map(off).collect();
            let mut edges: Vec<f64> = (0..SIZE.pixels()).filter(|i| !is_smooth(*i)).map(off).collect();
            let mean_of = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            let (mean, mean_edges) = (mean_of(&inside), mean_of(&edges));
            let (p99, edges99) = (quantile(&mut inside, 0.99), quantile(&mut edges, 0.99));
            let pairs = renderer.nearness().data.iter().zip(&expected.nearness_per_m.data);
            let wrong = pairs.filter(|(a, b)| !((**a - **b).abs() <= 1e-4 * b.abs() + 1e-7)).count();
            println!(
                "{name}: {mean:.3} mean, {p99} 99 % of {} smooth pixels; {mean_edges:.3}, {edges99} of {}; {wrong}",
                inside.len(),
                edges.len()
            );
            // Rounding to whole levels differs where single precision does.
            assert!(inside.len() > 10_000 && mean < 0.02 && p99 <= 1.0, "{name}: {mean} {p99}");
            // A coverage by four samples differs from that by sixteen by a tenth on average, at a contrast of 40
            // levels, where an edge passes through the pixel; it does in half of the pixels near one.
            assert!(mean_edges < 2.0 && edges99 <= 20.0, "{name}: {mean_edges} {edges99}");
            // Objects thinner than the sample spacing.
            assert!(wrong < 20, "{name}: {wrong}");
        }
    }
}

#[test]
fn the_next_frame_read_along_the_true_flow_is_this_frame() {
    let camera = camera(SIZE);
    let rays = RayTable::new(&camera).unwrap();
    for (name, world, poses) in worlds() {
        let flow = displacement(&world, &camera, &rays, &poses[0], &poses[1]).unwrap();
        for backend in backends() {
            for noise_levels in [0.0, 2.0] {
                let config = RendererConfig { noise_levels, ..CLEAN };
                let mut renderer = renderer(&backend, SIZE, &world, &config);
                let now = renderer.render(&poses[0], 1).unwrap().clone();
                let then = renderer.render(&poses[1], 2).unwrap().clone();
                let mut along = Vec::new();
                for (i, uv) in flow.data.iter().enumerate().filter(|(_, uv)| FlowField::is_known(**uv)) {
                    let pixel = [(i % 320) as f64, (i / 320) as f64];
                    let to = [pixel[0] + f64::from(uv[0]), pixel[1] + f64::from(uv[1])];
                    along.extend(sample(&then, to).map(|read| (read - f64::from(now.data[i])).abs()));
                }
                let median = quantile(&mut along, 0.5);
                println!("{name}, noise {noise_levels}: {median:.2} gray levels in the median");
                assert!(along.len() > 40_000, "{name}: {}", along.len());
                // The median of the difference of two noises of 2 levels is 1.9, less where the interpolation averages.
                let bound = if noise_levels > 0.0 { f64::hypot(1.5, 1.9) } else { 1.5 };
                assert!(median < bound, "{name}: {median}");
            }
        }
    }
}

/// For a texture too fine for the pixels the mean over each pixel would differ from the value at its centre.
#[test]
fn pictures_are_free_of_aliasing() {
    let size = Size::new(160, 120);
    let camera = camera(size);
    for (name, world, [pose, _]) in worlds() {
        let mut renderer = renderer(&Backend::Cpu, size, &world, &CLEAN);
        let image = renderer.render(&pose, 0).unwrap().clone();
        let is_smooth = smooth(&renderer.nearness().data, 160);
        let gray = |u: f64, v: f64| {
            let direction = pose.world_from_camera * camera.ray([u, v]).unwrap();
            let hit = world.hit(pose.position_world, direction);
            // With the pixel's size, not the samples'.
            world.gray(hit.as_ref(), direction, 1.0 / camera.f_u)
        };
        let square = |i: usize| {
            let (x, y) = ((i % 160) as f64, (i / 160) as f64);
            let shift = |k: usize| (k as f64 - 1.5) / 4.0;
            let mean = (0..16).map(|k| gray(x + shift(k % 4), y + shift(k / 4))).sum::<f64>() / 16.0;
            (mean - f64::from(image.data[i])).powi(2)
        };
        let squares: Vec<f64> = (0..size.pixels()).filter(|i| is_smooth(*i)).map(square).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        println!("{name}: {rms:.2} gray levels rms of {} pixels", squares.len());
        // The mean over a pixel takes a seventh off an octave of 14 levels and 3 pixels; aliased octaves differ by 14
        // each.
        assert!(squares.len() > 5000 && rms < 3.5, "{name}: {rms}");
    }
}

/// A far wall is passed in steps of a fraction of a pixel: the difference between images must equal the gradient
/// times the step, everywhere and always.
#[test]
fn a_far_wall_moves_by_less_than_a_pixel_without_a_jerk() {
    let world = scenes::frontal_wall(60.0).unwrap();
    let camera = Camera { lens: Lens::NONE, ..camera(SIZE) };
    for backend in backends() {
        let mut renderer = Renderer::new(backend.clone(), &camera, &world, &CLEAN).unwrap();
        let mut at = |step: i32| {
            let position_world = DVec3::X * (60.0 / 192.0 * 0.1 * f64::from(step));
            renderer.render(&Pose { position_world, ..scenes::START }, 0).unwrap().data.clone()
        };
        let first = at(0);
        for step in 1..=10 {
            let moved = at(step);
            // Least squares over the image (Lucas and Kanade): the gradient is that of both images' mean.
            let (mut product, mut square) = (0.0, 0.0);
            for i in (320..320 * 239).filter(|i| (1..319).contains(&(i % 320))) {
                let gradient = |image: &[u8]| (f64::from(image[i + 1]) - f64::from(image[i - 1])) / 2.0;
                let g = (gradient(&first) + gradient(&moved)) / 2.0;
                product += g * (f64::from(first[i]) - f64::from(moved[i]));
                square += g * g;
            }
            let (found, expected) = (product / square, -0.1 * f64::from(step));
            println!("{expected}: {found:.4}");
            // Central differences make the gradient of details of three pixels too small by up to a sixth, and the flow
            // too large.
            assert!((1.0..1.1).contains(&(found / expected)), "{expected}: {found}");
        }
        // A whole pixel further, every pixel equals its neighbour, up to a slightly different slant.
        let moved = at(10);
        let pixels = (0..320 * 240).filter(|i| i % 320 < 319);
        let off: Vec<f64> = pixels.map(|i| f64::from(moved[i].abs_diff(first[i + 1]))).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        println!("a pixel on: {mean:.3} gray levels in the mean");
        assert!(mean < 0.3, "{mean}");
    }
}

#[test]
fn noise_has_its_deviation_and_its_seed() {
    // The sky's gray is far from both ends of the range.
    let world = World::new(Vec::new());
    for backend in backends() {
        let mut clean = renderer(&backend, SIZE, &world, &CLEAN);
        let mut noisy = renderer(&backend, SIZE, &world, &RendererConfig::default());
        let without = clean.render(&scenes::START, 5).unwrap().data.clone();
        assert_eq!(without, clean.render(&scenes::START, 6).unwrap().data);
        let with = noisy.render(&scenes::START, 5).unwrap().data.clone();
        assert_eq!(with, noisy.render(&scenes::START, 5).unwrap().data);
        let other = noisy.render(&scenes::START, 5 + (1 << 32)).unwrap().data.clone();
        let difference = |a: &[u8], b: &[u8]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| f64::from(*a) - f64::from(*b)).collect()
        };
        for (pair, expected) in [(difference(&with, &without), 4.0), (difference(&with, &other), 8.0)] {
            let mean = pair.iter().sum::<f64>() / pair.len() as f64;
            let variance = pair.iter().map(|d| d * d).sum::<f64>() / pair.len() as f64;
            // Rounding adds a variance of 1/12 to each image.
            assert!(mean.abs() < 0.05 && (variance - expected - 1.0 / 6.0).abs() < 0.25, "{mean} {variance}");
        }
    }
}

#[test]
fn an_exposure_is_the_mean_of_its_poses() {
    let (_, world, poses) = worlds().swap_remove(3);
    let exposure: Vec<Pose> = (0..4)
        .map(|i| {
            let share = f64::from(i) / 4.0;
            Pose { position_world: poses[0].position_world.lerp(poses[1].position_world, share), ..poses[0] }
        })
        .collect();
    for backend in backends() {
        let mut renderer = renderer(&backend, SIZE, &world, &RendererConfig { blur_poses: 4, ..CLEAN });
        let blurred = renderer.expose(&exposure, 0).unwrap().data.clone();
        let nearness = renderer.nearness().clone();
        let sharp: Vec<Vec<u8>> =
            exposure.iter().map(|pose| renderer.render(pose, 0).unwrap().data.clone()).collect();
        for (i, level) in blurred.iter().enumerate() {
            let mean = sharp.iter().map(|image| f64::from(image[i])).sum::<f64>() / 4.0;
            assert!((mean - f64::from(*level)).abs() <= 1.0, "{i}: {mean} {level}");
        }
        assert!(blurred != sharp[0] && blurred != sharp[2]);
        renderer.render(&exposure[2], 0).unwrap();
        assert_eq!(renderer.nearness(), &nearness);
        assert!(renderer.expose(&exposure[..3], 0).is_err());
    }
}

#[test]
fn what_cannot_be_seen_is_an_error_or_black() {
    let world = scenes::yard(6.0).unwrap();
    let mut renderer = renderer(&Backend::Cpu, SIZE, &world, &CLEAN);
    for pose in [
        Pose { position_world: DVec3::new(0.0, f64::NAN, 0.0), ..scenes::START },
        Pose { world_from_camera: DMat3::NAN, ..scenes::START },
        Pose { world_from_camera: DMat3::IDENTITY * 1.1, ..scenes::START },
    ] {
        let text = renderer.render(&pose, 0).unwrap_err().to_string();
        assert!(!text.contains('\n'), "{text}");
    }
    assert!(renderer.render(&scenes::START, 0).is_ok());
    for config in [
        RendererConfig { noise_levels: f64::NAN, ..CLEAN },
        RendererConfig { noise_levels: -1.0, ..CLEAN },
        RendererConfig { blur_poses: 0, ..CLEAN },
        RendererConfig { blur_poses: 9, ..CLEAN },
        RendererConfig { range_m: f64::NAN, ..CLEAN },
    ] {
        assert!(Renderer::new(Backend::Cpu, &camera(SIZE), &world, &config).is_err(), "{config:?}");
    }
    let sideways = World { up_world: DVec3::NAN, ..world.clone() };
    assert!(Renderer::new(Backend::Cpu, &camera(SIZE), &sideways, &CLEAN).is_err());
    // The lens map folds at a radius of 1.05, well inside this wide image.
    let lens = Lens::new(&[-0.3, 0.0, 0.0, 0.0]).unwrap();
    let folding = Camera { f_u: 80.0, f_v: 80.0, lens, ..camera(SIZE) };
    let mut renderer = Renderer::new(Backend::Cpu, &folding, &world, &CLEAN).unwrap();
    assert_eq!(renderer.render(&scenes::START, 0).unwrap().data[0], 0);
    assert!(renderer.nearness().data[0].is_nan() && !renderer.nearness().data[120 * 320 + 160].is_nan());
}

#[test]
fn more_than_there_is_room_for_is_an_error_and_range_makes_room() {
    let grid = (0..40_000).map(|i| {
        let place = DVec3::new(20.0 + 0.7 * f64::from(i % 200), 0.7 * f64::from(i / 200) - 70.0, 0.0);
        Surface::cylinder(place, place - DVec3::Z * 30.0, 0.1).unwrap()
    });
    let world = World { surfaces: grid.collect(), up_world: DVec3::NEG_Z };
    let pose = flying([0.0, 0.0, -10.0], [0.0; 3]);
    let mut all = renderer(&Backend::Cpu, SIZE, &world, &CLEAN);
    let text = all.render(&pose, 0).unwrap_err().to_string();
    assert!(text.contains("expected at most"), "{text}");
    let mut near = renderer(&Backend::Cpu, SIZE, &world, &RendererConfig { range_m: 25.0, ..CLEAN });
    near.render(&pose, 0).unwrap();
}

#[test]
fn the_smallest_images_show_a_whole_forest() {
    let course = "forest".parse::<viewsphere::sim::CourseKind>().unwrap().course(0).unwrap();
    assert!(course.world.surfaces.len() > 300);
    let pose = flying([0.0, 0.0, -10.0], [0.0; 3]);
    for size in [Size::new(1, 1), Size::new(8, 8), Size::new(40, 8)] {
        let mut renderer = renderer(&Backend::Cpu, size, &course.world, &CLEAN);
        assert_eq!(renderer.render(&pose, 0).unwrap().size, size);
    }
}

#[test]
fn a_lost_device_is_an_error() {
    let Some(shared) = need::gpu() else { return };
    let gpu = shared.reopen().unwrap();
    let world = scenes::yard(6.0).unwrap();
    let mut renderer = renderer(&Backend::Gpu(gpu.clone()), SIZE, &world, &CLEAN);
    renderer.render(&scenes::START, 0).unwrap();
    gpu.device().destroy();
    for _ in 0..2 {
        let error = renderer.render(&scenes::START, 0).unwrap_err();
        assert!(matches!(error, Error::DeviceLost { .. }), "{error}");
    }
}
