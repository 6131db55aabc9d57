//! The ground truth, compared with finite differences and with rendered images.

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use viewsphere::camera::{Camera, Lens, Pose};
use viewsphere::frame::{FlowField, Size};
use viewsphere::sim::scenes::{self, START};
use viewsphere::sim::{RayTable, Surface, Twist, World, displacement, reference_render};

use crate::sample::sample;

fn camera(size: Size, coefficients: &[f64]) -> Camera {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let lens = Lens::new(coefficients).unwrap();
    let f = 0.6 * width;
    Camera { size, f_u: f, f_v: f, u_0: (width - 1.0) / 2.0, v_0: (height - 1.0) / 2.0, lens }
}

const BARREL: [f64; 4] = [-0.28, 0.07, 2e-4, 2e-5];

fn worlds() -> Vec<(&'static str, World)> {
    vec![
        ("frontal wall", scenes::frontal_wall(5.0).unwrap()),
        ("oblique wall", scenes::oblique_wall(5.0, 0.8).unwrap()),
        ("pillar", scenes::pillar(4.0, 0.5).unwrap()),
        ("corridor", scenes::corridor(20.0).unwrap()),
        ("yard", scenes::yard(6.0).unwrap()),
    ]
}

/// A pose slightly off the start.
fn off(step: f64) -> Pose {
    let turn = DMat3::from_rotation_y(0.06 * step) * DMat3::from_rotation_x(-0.03 * step);
    Pose {
        position_world: DVec3::new(0.11, -0.07, 0.3) * step,
        world_from_camera: turn * DMat3::from_rotation_z(0.05 * step),
    }
}

#[test]
fn distances_are_those_of_the_closed_forms() {
    let o = DVec3::ZERO;
    let wall = scenes::oblique_wall(5.0, 0.6).unwrap();
    for p in [DVec3::new(0.2, -0.1, 1.0), DVec3::new(-0.3, 0.4, 1.0), DVec3::Z].map(DVec3::normalize) {
        let n = DVec3::new(0.6_f64.sin(), 0.0, -0.6_f64.cos());
        let hit = wall.hit(o, p).unwrap();
        assert!((hit.distance_m - 5.0 * n.z / n.dot(p)).abs() < 1e-12);
        assert!((hit.normal_world - n).length() < 1e-12);
    }
    // A pillar of radius 0.5 whose axis is 4.5 m away: 4.5 cos a − √(0.25 − 4.5² sin² a).
    let pillar = scenes::pillar(4.0, 0.5).unwrap();
    for a in [0.0, 0.05, -0.09, 0.11] {
        let hit = pillar.hit(o, DVec3::new(f64::sin(a), 0.0, f64::cos(a))).unwrap();
        let expected = 4.5 * f64::cos(a) - (0.25 - (4.5 * f64::sin(a)).powi(2)).sqrt();
        assert!(hit.surface == 0 && (hit.distance_m - expected).abs() < 1e-12, "{a}: {hit:?}");
    }
    assert_eq!(pillar.hit(o, DVec3::new(0.12, 0.0, 1.0).normalize()).unwrap().surface, 1);
    assert_eq!(pillar.hit(o, DVec3::NEG_Z), None);
    assert_eq!(scenes::frontal_wall(3.0).unwrap().hit(o, DVec3::X), None);
}

#[test]
fn lids_edges_and_insides_are_met() {
    let (o, z) = (DVec3::ZERO, DVec3::Z);
    let solo = |surface| World::new(vec![surface]);
    let along = solo(Surface::cylinder(z * 3.0, z * 5.0, 0.5).unwrap());
    let lid = along.hit(o, z).unwrap();
    assert_eq!((lid.distance_m, lid.face, lid.normal_world), (3.0, 1, -z));
    let inside = along.hit(z * 4.0, z).unwrap();
    assert_eq!((inside.distance_m, inside.face, inside.normal_world), (1.0, 2, -z));
    assert!((along.hit(z * 4.0, DVec3::X).unwrap().distance_m - 0.5).abs() < 1e-12);
    assert_eq!(along.hit(DVec3::X * 0.6, z), None);
    let cube = solo(Surface::cuboid(z * 4.0, DMat3::IDENTITY, DVec3::new(2.0, 2.0, 2.0)).unwrap());
    assert_eq!(cube.hit(o, z).unwrap().distance_m, 3.0);
    assert_eq!(cube.hit(z * 4.0, DVec3::X).unwrap().distance_m, 1.0);
    assert_eq!(cube.hit(DVec3::X * 1.01, z), None);
    assert_eq!(cube.hit(z * 9.0, z), None);
    let faces: Vec<u32> = [DVec3::X, DVec3::Y, z]
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .map(|axis| cube.hit(z * 4.0 - 3.0 * axis, axis).unwrap().face)
        .collect();
    assert_eq!(faces, [0, 1, 2, 3, 4, 5]);
    let pane = solo(Surface::rectangle(z * 2.0, DVec3::X, DVec3::NEG_Y * 0.5).unwrap());
    assert!(pane.hit(DVec3::new(0.99, 0.49, 0.0), z).is_some());
    assert!(pane.hit(DVec3::new(1.01, 0.0, 0.0), z).is_none() && pane.hit(DVec3::Y * 0.51, z).is_none());
}

#[test]
fn shapes_that_are_none_are_errors() {
    let (o, z) = (DVec3::ZERO, DVec3::Z);
    for result in [
        Surface::plane(o, o),
        Surface::plane(DVec3::NAN, z),
        Surface::cylinder(o, o, 1.0),
        Surface::cylinder(o, z, 0.0),
        Surface::cylinder(o, z, f64::NAN),
        Surface::cuboid(o, DMat3::IDENTITY * 2.0, DVec3::ONE),
        Surface::cuboid(o, DMat3::IDENTITY, DVec3::new(1.0, -1.0, 1.0)),
        Surface::rectangle(o, z, z),
    ] {
        let text = result.unwrap_err().to_string();
        assert!(!text.contains('\n'), "{text}");
    }
    assert!(scenes::frontal_wall(f64::NAN).is_err());
}

/// The pose of a camera after moving for a time at constant rates in its own frame.
fn after(pose: &Pose, motion: &Twist, time_s: f64) -> Pose {
    // Close enough to a constant velocity for a difference that is symmetric in time.
    Pose {
        position_world: pose.position_world + pose.world_from_camera * motion.velocity_m_s * time_s,
        world_from_camera: pose.world_from_camera
            * DMat3::from_quat(glam::DQuat::from_scaled_axis(motion.rate_rad_s * time_s)),
    }
}

const MOTION: Twist =
    Twist { velocity_m_s: DVec3::new(0.7, -0.4, 3.0), rate_rad_s: DVec3::new(0.3, -0.5, 0.9) };

#[test]
fn flow_and_divergence_are_those_of_finite_differences() {
    let (dt, da) = (1e-5, 1e-4);
    for (name, world) in worlds() {
        let pose = off(1.0);
        for bearing in [[0.02, 0.03], [-0.4, 0.2], [0.3, -0.35], [0.05, 0.45]] {
            let p = DVec3::new(bearing[0], bearing[1], 1.0).normalize();
            let seen = world.seen(&pose, p);
            // The bearing of the same point, a moment later and a moment earlier.
            let direction = pose.world_from_camera * p;
            let bearing_at = |t: f64| {
                let later = after(&pose, &MOTION, t);
                let relative = match world.hit(pose.position_world, direction) {
                    Some(hit) => pose.position_world + hit.distance_m * direction - later.position_world,
                    None => direction,
                };
                (later.world_from_camera.transpose() * relative).normalize()
            };
            let difference = (bearing_at(dt) - bearing_at(-dt)) / (2.0 * dt);
            let flow = seen.flow_rad_s(&MOTION);
            assert!((flow - difference).length() < 1e-8, "{name}: {flow} {difference}");
            // Divergence: the flow along two directions perpendicular to the bearing, on either side.
            let (e1, e2) = p.any_orthonormal_pair();
            let slope = |e: DVec3| {
                let flow_at = |s: f64| world.seen(&pose, (p + s * e).normalize()).flow_rad_s(&MOTION).dot(e);
                (flow_at(da) - flow_at(-da)) / (2.0 * da)
            };
            let (found, expected) = (seen.divergence_per_s(&MOTION), slope(e1) + slope(e2));
            assert!((found - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{name}: {found} {expected}");
        }
    }
}

#[test]
fn a_wall_ahead_diverges_by_two_over_the_time_to_contact() {
    let motion = Twist { velocity_m_s: DVec3::Z * 2.0, rate_rad_s: DVec3::ZERO };
    let seen = scenes::frontal_wall(5.0).unwrap().seen(&START, DVec3::Z);
    assert!((seen.divergence_per_s(&motion) - 0.8).abs() < 1e-12);
    assert!((seen.nearness_rate_per_s(&motion) - 0.4).abs() < 1e-12);
    let sky = scenes::frontal_wall(5.0).unwrap().seen(&START, DVec3::NEG_Z);
    assert_eq!((sky.nearness_per_m, sky.divergence_per_s(&MOTION)), (0.0, 0.0));
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn the_next_frame_read_along_the_true_flow_is_this_frame() {
    let size = Size::new(320, 240);
    for coefficients in [&[][..], &BARREL] {
        let camera = camera(size, coefficients);
        let rays = RayTable::new(&camera).unwrap();
        for (name, world) in worlds() {
            let poses = [off(0.2), off(0.45)];
            let [now, then] = poses.map(|pose| reference_render(&world, &rays, &pose).image);
            let flow = displacement(&world, &camera, &rays, &poses[0], &poses[1]).unwrap();
            let (mut along, mut still) = (Vec::new(), Vec::new());
            for (i, uv) in flow.data.iter().enumerate().filter(|(_, uv)| FlowField::is_known(**uv)) {
                let pixel = [(i % 320) as f64, (i / 320) as f64];
                let to = [pixel[0] + f64::from(uv[0]), pixel[1] + f64::from(uv[1])];
                if let (Some(read), Some(same)) = (sample(&then, to), sample(&then, pixel)) {
                    along.push((read - f64::from(now.data[i])).abs());
                    still.push((same - f64::from(now.data[i])).abs());
                }
            }
            let (count, mean) = (along.len(), along.iter().sum::<f64>() / along.len() as f64);
            let medians = [median(&mut along), median(&mut still)];
            println!(
                "{name}: {mean:.2} mean, {medians:.2?} median gray levels along the flow and without it"
            );
            assert!(count > 40_000, "{name}: {count}");
            // Half a gray level is rounding; the rest is what interpolation loses of details of three pixels, and
            // octaves that become visible.
            assert!(medians[0] < 1.5 && mean < 2.5, "{name}: {mean} {medians:?}");
            assert!(medians[1] > 4.0 * medians[0], "{name}: {medians:?}");
        }
    }
}

/// For a texture too fine for the pixels the mean over each pixel would differ from the value at its centre.
#[test]
fn pictures_are_free_of_aliasing() {
    let camera = camera(Size::new(160, 120), &BARREL);
    let rays = RayTable::new(&camera).unwrap();
    for (name, world) in worlds() {
        let pose = off(0.5);
        let image = reference_render(&world, &rays, &pose).image;
        let gray = |u: f64, v: f64| {
            let direction = pose.world_from_camera * camera.ray([u, v]).unwrap();
            let hit = world.hit(pose.position_world, direction);
            // With the pixel's size, not the samples'.
            world.gray(hit.as_ref(), direction, 1.0 / camera.f_u)
        };
        let mut differences: Vec<f64> = Vec::new();
        for (i, pixel) in image.data.iter().enumerate() {
            let (x, y) = ((i % 160) as f64, (i / 160) as f64);
            let shift = |k: usize| (k as f64 - 1.5) / 4.0;
            let mean = (0..16).map(|k| gray(x + shift(k % 4), y + shift(k / 4))).sum::<f64>() / 16.0;
            differences.push((mean - f64::from(*pixel)).powi(2));
        }
        let rms = (differences.iter().sum::<f64>() / differences.len() as f64).sqrt();
        println!("{name}: {rms:.2} gray levels rms");
        // The mean over a pixel takes a seventh off an octave of 14 levels and 3 pixels; aliased octaves differ by 14
        // each.
        assert!(rms < 3.5, "{name}: {rms}");
    }
}

#[test]
fn nearness_is_that_of_the_rays_and_pictures_are_the_same_twice() {
    let camera = camera(Size::new(97, 65), &BARREL);
    let rays = RayTable::new(&camera).unwrap();
    for (name, world) in worlds() {
        let view = reference_render(&world, &rays, &off(1.0));
        assert_eq!(view, reference_render(&world, &rays, &off(1.0)), "{name}");
        for (i, nearness) in view.nearness_per_m.data.iter().enumerate() {
            let bearing = rays.bearing(i as u32 % 97, i as u32 / 97).unwrap();
            // With all surfaces, where the renderer knows which ones can be met.
            assert_eq!(*nearness, world.seen(&off(1.0), bearing).nearness_per_m as f32, "{name} {i}");
        }
        assert_ne!(view.image, reference_render(&world, &rays, &START).image, "{name}");
    }
    let one = Camera { size: Size::new(1, 1), ..camera };
    assert_eq!(
        reference_render(&scenes::yard(5.0).unwrap(), &RayTable::new(&one).unwrap(), &START).image.data.len(),
        1
    );
}

#[test]
fn where_the_lens_shows_nothing_it_is_black_and_unknown() {
    // The lens map folds at a radius of 1.05, well inside this wide image.
    let folding = Camera { f_u: 40.0, f_v: 40.0, ..camera(Size::new(160, 120), &[-0.3, 0.0, 0.0, 0.0]) };
    let rays = RayTable::new(&folding).unwrap();
    let view = reference_render(&scenes::frontal_wall(2.0).unwrap(), &rays, &START);
    assert!(view.nearness_per_m.data[0].is_nan() && view.image.data[0] == 0 && rays.bearing(0, 0).is_none());
    assert!((view.nearness_per_m.data[60 * 160 + 80] - 0.5).abs() < 1e-3);
    let flow = displacement(&scenes::frontal_wall(2.0).unwrap(), &folding, &rays, &START, &off(0.1)).unwrap();
    assert!(!FlowField::is_known(flow.data[0]) && FlowField::is_known(flow.data[60 * 160 + 80]));
}

#[test]
fn what_a_pillar_covers_has_no_flow() {
    let camera = camera(Size::new(160, 120), &[]);
    let rays = RayTable::new(&camera).unwrap();
    let aside = Pose { position_world: DVec3::X * 0.3, ..START };
    let world = scenes::pillar(4.0, 0.5).unwrap();
    let flow = displacement(&world, &camera, &rays, &START, &aside).unwrap();
    let row = &flow.data[60 * 160..61 * 160];
    let hidden: Vec<usize> = (0..160).filter(|x| !FlowField::is_known(row[*x])).collect();
    // The camera moves right, so the pillar moves left, by 7 pixels more than the background.
    assert!((5..=9).contains(&hidden.len()) && hidden.iter().all(|x| *x < 80), "{hidden:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_hit_lies_on_the_ray_in_front_of_everything(
        from in prop::array::uniform3(-3.0..3.0_f64),
        to in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let Some(direction) = DVec3::from(to).try_normalize() else { return Ok(()) };
        let origin = DVec3::from(from);
        for (_, world) in worlds() {
            let Some(hit) = world.hit(origin, direction) else { continue };
            prop_assert!(hit.distance_m > 0.0 && hit.distance_m.is_finite());
            prop_assert!((hit.normal_world.length() - 1.0).abs() < 1e-9);
            prop_assert!(hit.normal_world.dot(direction) <= 0.0);
            // Just in front of the surface it is just ahead.
            let near = world.hit(origin + direction * (hit.distance_m * (1.0 - 1e-6)), direction).unwrap();
            prop_assert!((near.distance_m - hit.distance_m * 1e-6).abs() < 1e-6 * (1.0 + hit.distance_m));
            let gray = world.gray(Some(&hit), direction, 1e-3);
            prop_assert!((0.0..=255.0).contains(&gray));
        }
    }
}
