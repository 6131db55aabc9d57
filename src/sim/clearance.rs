//! The distance from a point to the surfaces of a world.

use glam::{DVec2, DVec3};

use super::surface::Geometry;
use super::{Surface, World};

impl Surface {
    /// The distance from a point to the surface, metres: negative inside a cylinder or a box and behind a plane,
    /// whose normal points to the free side. A rectangle is thin and has no inside.
    pub fn distance_m(&self, point_world: DVec3) -> f64 {
        let p = self.local_from_world * (point_world - self.origin_world);
        match self.shape {
            Geometry::Plane => p.z,
            Geometry::Rectangle { half_m: [a, b] } => {
                DVec3::new((p.x.abs() - a).max(0.0), (p.y.abs() - b).max(0.0), p.z).length()
            }
            Geometry::Cylinder { radius_m, length_m } => {
                let half_m = length_m / 2.0;
                solid(DVec3::new(
                    DVec2::new(p.x, p.y).length() - radius_m,
                    (p.z - half_m).abs() - half_m,
                    f64::MIN,
                ))
            }
            Geometry::Cuboid { half_m } => solid(p.abs() - half_m),
        }
    }
}

/// The signed distance to a box-like body, from the signed distances to its bounds.
fn solid(beyond: DVec3) -> f64 {
    beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
}

impl World {
    /// The distance from a point to the nearest surface, metres: negative inside a solid, as in
    /// [`Surface::distance_m`]. Infinite in an empty world, and NaN for a point that is not finite.
    pub fn clearance_m(&self, point_world: DVec3) -> f64 {
        if !point_world.is_finite() {
            return f64::NAN;
        }
        let mut nearest_m = f64::INFINITY;
        for surface in &self.surfaces {
            // Skip surfaces whose bounding sphere is too far away.
            if point_world.distance(surface.origin_world) - surface.reach_m < nearest_m {
                nearest_m = nearest_m.min(surface.distance_m(point_world));
            }
        }
        nearest_m
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sim::Form;
    use glam::{DMat3, EulerRot};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// Points along a side or around a circle.
    const STEPS: i32 = 60;

    fn surfaces() -> Vec<Surface> {
        let turn = DMat3::from_euler(EulerRot::ZYX, 0.7, -0.4, 1.1);
        vec![
            Surface::rectangle(DVec3::new(1.0, -2.0, 0.5), turn.x_axis * 1.5, turn.y_axis * 0.4).unwrap(),
            Surface::cylinder(DVec3::new(0.3, 0.2, 1.0), DVec3::new(-1.0, 0.9, -1.5), 0.8).unwrap(),
            Surface::cylinder(DVec3::ZERO, DVec3::NEG_Z * 0.1, 2.0).unwrap(),
            Surface::cuboid(DVec3::new(-1.0, 0.5, 0.0), turn, DVec3::new(0.6, 2.0, 3.0)).unwrap(),
        ]
    }

    /// Points on a surface, and the largest distance of any of its points from the nearest of them.
    fn sampled(form: Form) -> (Vec<DVec3>, f64) {
        let unit = |i: i32| f64::from(i) / f64::from(STEPS);
        let grid = || (0..=STEPS).flat_map(move |i| (0..=STEPS).map(move |j| (unit(i), unit(j))));
        match form {
            Form::Plane { .. } => panic!("a plane has no end"),
            Form::Rectangle { centre_world, to_right, to_top } => {
                let at = |(s, t)| centre_world + to_right * (2.0 * s - 1.0) + to_top * (2.0 * t - 1.0);
                (grid().map(at).collect(), (to_right.length() + to_top.length()) / f64::from(STEPS))
            }
            Form::Cylinder { base_world, top_world, radius_m } => {
                let (u, v) = (top_world - base_world).normalize().any_orthonormal_pair();
                let around = |s: f64| radius_m * (u * (TAU * s).cos() + v * (TAU * s).sin());
                let mantle = grid().map(|(s, t)| base_world.lerp(top_world, t) + around(s));
                let lid = |centre: DVec3| grid().map(move |(s, t)| centre + around(s) * t);
                let step = TAU * radius_m + base_world.distance(top_world);
                (mantle.chain(lid(base_world)).chain(lid(top_world)).collect(), step / f64::from(STEPS))
            }
            Form::Cuboid { centre_world, world_from_box, edges_m } => {
                let mut points = Vec::new();
                for (axis, side) in (0..3).flat_map(|axis| [(axis, -0.5), (axis, 0.5)]) {
                    points.extend(grid().map(|(s, t)| {
                        let mut at = DVec3::ZERO;
                        (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, s - 0.5, t - 0.5);
                        centre_world + world_from_box * (at * edges_m)
                    }));
                }
                (points, edges_m.element_sum() / f64::from(STEPS))
            }
        }
    }

    /// Whether a point is inside, by definition.
    fn is_inside(form: Form, point: DVec3) -> bool {
        match form {
            Form::Plane { point_world, normal_world } => (point - point_world).dot(normal_world) < 0.0,
            Form::Rectangle { .. } => false,
            Form::Cylinder { base_world, top_world, radius_m } => {
                let axis = (top_world - base_world).normalize();
                let (from_base, from_top) = (point - base_world, point - top_world);
                from_base.dot(axis) > 0.0
                    && from_top.dot(axis) < 0.0
                    && from_base.cross(axis).length() < radius_m
            }
            Form::Cuboid { centre_world, world_from_box, edges_m } => {
                let p = point - centre_world;
                (0..3).all(|axis| p.dot(world_from_box.col(axis)).abs() < edges_m[axis] / 2.0)
            }
        }
    }

    #[test]
    fn distances_have_their_closed_forms() {
        let ground = Surface::plane(DVec3::new(3.0, 4.0, 1.0), DVec3::NEG_Z * 2.0).unwrap();
        let wall = Surface::rectangle(DVec3::ZERO, DVec3::Y * 2.0, DVec3::NEG_Z).unwrap();
        let trunk = Surface::cylinder(DVec3::ZERO, DVec3::NEG_Z * 10.0, 0.5).unwrap();
        let house = Surface::cuboid(DVec3::ZERO, DMat3::IDENTITY, DVec3::new(2.0, 4.0, 6.0)).unwrap();
        let cases = [
            (&ground, [7.0, -8.0, -9.0], 10.0),
            (&ground, [7.0, -8.0, 1.5], -0.5),
            (&wall, [-3.0, 1.0, 0.5], 3.0),
            (&wall, [3.0, 1.0, 0.5], 3.0),
            (&wall, [0.0, 5.0, -5.0], 5.0),
            (&wall, [12.0, 5.0, -5.0], 13.0),
            (&trunk, [3.0, 4.0, -2.0], 4.5),
            (&trunk, [3.5, 0.0, 4.0], 5.0),
            (&trunk, [0.1, 0.0, -5.0], -0.4),
            (&trunk, [0.1, 0.0, -9.9], -0.1),
            (&trunk, [0.0, 0.3, -12.0], 2.0),
            (&house, [4.0, 6.0, 0.0], 5.0),
            (&house, [2.0, 4.0, -5.0], 3.0),
            (&house, [0.0, 1.9, 0.0], -0.1),
            (&house, [0.0, 0.0, 0.0], -1.0),
        ];
        for (surface, point, expected) in cases {
            let found = surface.distance_m(DVec3::from(point));
            // A few roundings of numbers about 10.
            assert!((found - expected).abs() <= 1e-14, "{:?} from {point:?}: {found}", surface.form());
        }
    }

    #[test]
    fn a_world_is_as_near_as_its_nearest_surface() {
        let mut world = World::new(surfaces());
        let point = DVec3::new(2.0, 1.0, 0.3);
        let nearest = world.surfaces.iter().map(|surface| surface.distance_m(point)).fold(9.0, f64::min);
        assert_eq!(world.clearance_m(point), nearest);
        assert!(world.clearance_m(DVec3::new(0.0, f64::NAN, 0.0)).is_nan());
        assert!(world.clearance_m(DVec3::new(0.0, f64::INFINITY, 0.0)).is_nan());
        world.surfaces.clear();
        assert_eq!(world.clearance_m(point), f64::INFINITY);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

        #[test]
        fn distances_are_those_to_the_nearest_sample(point in prop::array::uniform3(-3.0..3.0_f64)) {
            let point = DVec3::from(point);
            for surface in surfaces() {
                let (samples, step_m) = sampled(surface.form());
                let nearest = samples.iter().map(|sample| sample.distance(point)).fold(f64::INFINITY, f64::min);
                let found = surface.distance_m(point);
                // The nearest point is within a step of a sample, and no sample is nearer.
                prop_assert!(found.abs() <= nearest + 1e-12, "{found} {nearest}");
                prop_assert!(nearest <= (found * found + step_m * step_m).sqrt() + step_m * step_m, "{found} {nearest}");
                prop_assert_eq!(found < 0.0, is_inside(surface.form(), point));
            }
        }

        #[test]
        fn the_nearest_place_is_on_the_surface_and_no_ray_meets_it_sooner(
            point in prop::array::uniform3(-3.0..3.0_f64),
            to in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let (point, Some(direction)) = (DVec3::from(point), DVec3::from(to).try_normalize()) else { return Ok(()) };
            for surface in surfaces() {
                let distance_m = surface.distance_m(point);
                if let Some(hit) = surface.hit(point, direction) {
                    prop_assert!(hit.distance_m >= distance_m.abs() - 1e-9);
                }
                if !(distance_m > 0.01) {
                    continue;
                }
                let slope = DVec3::AXES.map(|axis| {
                    let [more, less] = [1e-5, -1e-5].map(|step| surface.distance_m(point + axis * step));
                    (more - less) / 2e-5
                });
                let nearest = point - DVec3::from(slope) * distance_m;
                // The second-order error of the slope, 1e-10 over the distance squared, times the distance.
                prop_assert!(surface.distance_m(nearest).abs() <= 1e-5);
            }
        }
    }
}
