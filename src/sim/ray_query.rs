//! Queries of many rays at once.

use rayon::prelude::*;

use super::rays::TILE;
use super::reference_render::reached;
use super::{RayTable, Seen, World};
use crate::camera::Pose;
use crate::error::Result;
use crate::frame::{Plane, Size};
use crate::sphere::Grid;

/// What each pixel's ray meets, one element per pixel, row by row; `None` where the lens shows nothing.
pub fn query_rays(world: &World, rays: &RayTable, pose: &Pose) -> Vec<Option<Seen>> {
    let width = rays.size().width as usize;
    let mut hits = vec![None; rays.size().pixels()];
    hits.par_chunks_mut(width * TILE).enumerate().for_each(|(tile_y, band)| {
        for tile_x in 0..width.div_ceil(TILE) {
            let surfaces = reached(world, rays, pose, [tile_x, tile_y]);
            for (row, hits) in band.chunks_exact_mut(width).enumerate() {
                for (x, seen) in hits.iter_mut().enumerate().skip(tile_x * TILE).take(TILE) {
                    let bearing = rays.bearing(x as u32, (tile_y * TILE + row) as u32);
                    *seen = bearing.map(|bearing| world.seen_among(surfaces.iter().copied(), pose, bearing));
                }
            }
        }
    });
    hits
}

/// Distances along rays through the centres of a grid's sectors, metres: infinite for the sky. Rows and columns are
/// those of the [`Grid`], which defines azimuth and elevation.
///
/// This scans the space in front of a simulated aircraft by ray casts, at any resolution.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for a grid without rows or columns, or with more than an image may
/// have.
pub fn ray_grid(world: &World, pose: &Pose, grid: &Grid) -> Result<Plane> {
    let side = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let size = Size::new(side(grid.columns), side(grid.rows)).validate()?;
    let distance_m = |i: usize| {
        let bearing = grid.bearing(i % grid.columns, i / grid.columns);
        let hit = world.hit(pose.position_world, pose.world_from_camera * bearing);
        hit.map_or(f32::INFINITY, |hit| hit.distance_m as f32)
    };
    Ok(Plane { size, data: (0..size.pixels()).into_par_iter().map(distance_m).collect() })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Lens};
    use crate::sim::{CourseKind, Twist, displacement};
    use glam::DVec3;

    fn camera() -> Camera {
        let lens = Lens::new(&[-0.28, 0.075, 3e-4, -2e-4]).unwrap();
        Camera { size: Size::new(61, 47), f_u: 33.0, f_v: 33.0, u_0: 30.0, v_0: 23.0, lens }
    }

    fn pose(forward_m: f64) -> Pose {
        let turn = crate::camera::world_from_body(0.1, -0.05, 0.2 + 0.01 * forward_m);
        Pose {
            position_world: DVec3::new(30.0 + forward_m, 1.0, -10.0),
            world_from_camera: turn * crate::camera::FRD_FROM_CAMERA,
        }
    }

    #[test]
    fn each_pixel_sees_what_its_ray_meets() {
        let world = "city".parse::<CourseKind>().unwrap().course(3).unwrap().world;
        let (camera, pose) = (camera(), pose(0.0));
        let rays = RayTable::new(&camera).unwrap();
        let hits = query_rays(&world, &rays, &pose);
        let mut solid = 0;
        for (i, seen) in hits.iter().enumerate() {
            let bearing = rays.bearing(i as u32 % 61, i as u32 / 61);
            // Tiles skip what they cannot see, and nothing else.
            assert_eq!(*seen, bearing.map(|bearing| world.seen(&pose, bearing)), "{i}");
            solid += usize::from(seen.is_some_and(|seen| seen.nearness_per_m > 0.0));
        }
        assert!(solid > 1000, "{solid}");
    }

    /// The later camera is beside, behind and rotated against the earlier one, so that other things occlude.
    #[test]
    fn what_is_hidden_is_what_something_stands_before() {
        let world = "forest:density=1/40".parse::<CourseKind>().unwrap().course(3).unwrap().world;
        let (camera, from) = (camera(), pose(3.0));
        let rays = RayTable::new(&camera).unwrap();
        let [mut hidden, mut shown] = [0, 0];
        for off in [DVec3::new(-2.0, 3.0, 0.5), DVec3::new(3.0, -1.0, -1.0)] {
            let to = Pose { position_world: from.position_world + off, ..pose(5.0) };
            let flow = displacement(&world, &camera, &rays, &from, &to).unwrap();
            for (i, seen) in query_rays(&world, &rays, &from).into_iter().enumerate() {
                let Some(seen) = seen.filter(|seen| seen.nearness_per_m > 0.0) else { continue };
                let place = from.world_from_camera * seen.bearing / seen.nearness_per_m - off;
                let first = world.hit(to.position_world, place.normalize());
                let free = first.is_some_and(|first| first.distance_m > place.length() * (1.0 - 1e-6));
                let inside = camera.project(to.world_from_camera.transpose() * place).is_some();
                let known = crate::frame::FlowField::is_known(flow.data[i]);
                assert_eq!(known, free && inside, "{i}");
                (hidden, shown) = (hidden + usize::from(!free), shown + usize::from(known));
            }
        }
        assert!(hidden > 50 && shown > 2000, "{hidden} {shown}");
    }

    /// A point's displacement in a very short time matches its flow on the sphere.
    #[test]
    fn the_spherical_flow_is_the_displacement_of_a_short_time() {
        let world = "city".parse::<CourseKind>().unwrap().course(3).unwrap().world;
        let (camera, [from, to]) = (camera(), [0.0, 1e-4].map(pose));
        let rays = RayTable::new(&camera).unwrap();
        let pixels = displacement(&world, &camera, &rays, &from, &to).unwrap();
        // At 1 m/s the distance equals the time.
        let turn = from.world_from_camera.transpose() * to.world_from_camera;
        let rate = DVec3::new(
            turn.y_axis.z - turn.z_axis.y,
            turn.z_axis.x - turn.x_axis.z,
            turn.x_axis.y - turn.y_axis.x,
        ) * (0.5 / 1e-4);
        let motion = Twist { velocity_m_s: from.world_from_camera.transpose() * DVec3::X, rate_rad_s: rate };
        let mut compared = 0;
        for (i, seen) in query_rays(&world, &rays, &from).into_iter().enumerate() {
            let (Some(seen), uv) = (seen, pixels.data[i]) else { continue };
            if !crate::frame::FlowField::is_known(uv) {
                continue;
            }
            let there = camera.project(seen.bearing + 1e-4 * seen.flow_rad_s(&motion)).unwrap();
            let expected = [there[0] - (i % 61) as f64, there[1] - (i / 61) as f64];
            // The displacement is an f32 of about 1e-3 px, the second order of the motion about 1e-7 px.
            let off = (f64::from(uv[0]) - expected[0]).hypot(f64::from(uv[1]) - expected[1]);
            assert!(off <= 1e-6, "{i}: {uv:?} {expected:?}");
            compared += 1;
        }
        assert!(compared > 2000, "{compared}");
    }

    #[test]
    fn a_grid_of_rays_measures_distances() {
        // In level flight over the ground, the ray at elevation −e meets the ground at h / sin e.
        let world = World::new(vec![crate::sim::Surface::plane(DVec3::ZERO, DVec3::NEG_Z).unwrap()]);
        let pose = Pose {
            position_world: DVec3::new(0.0, 0.0, -10.0),
            world_from_camera: crate::camera::FRD_FROM_CAMERA,
        };
        let grid = Grid { columns: 5, rows: 4, azimuth_rad: [-0.8, 0.8], elevation_rad: [0.6, -0.6] };
        let plane = ray_grid(&world, &pose, &grid).unwrap();
        for (i, distance_m) in plane.data.iter().enumerate() {
            let [_, elevation] = grid.angles_rad(i % 5, i / 5);
            let expected = if elevation < 0.0 { 10.0 / (-elevation).sin() } else { f64::INFINITY };
            let same = f64::from(*distance_m) == expected;
            assert!(same || (f64::from(*distance_m) / expected - 1.0).abs() <= 1e-6, "{i} {distance_m}");
        }
        assert!(ray_grid(&world, &pose, &Grid { rows: 0, ..grid }).is_err());
    }
}
