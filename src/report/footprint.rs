//! Surfaces as seen from straight above.

use glam::{DMat3, DVec2, DVec3};

use crate::sim::Form;

/// The number of points around a lid of a cylinder that is not upright.
const AROUND: u32 = 16;
/// A steeper plane is drawn as its line at a given height; any other is ground.
const STEEP: f64 = 0.2;
/// Half the length drawn of an infinite line, metres.
const FAR_M: f64 = 1e4;

/// The outline of a surface as seen from straight above, in metres north and east.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Footprint {
    /// An upright cylinder.
    Circle(DVec2, f64),
    /// An upright wall.
    Line([DVec2; 2]),
    /// Any other bounded surface: its corners in order.
    Polygon(Vec<DVec2>),
}

impl Footprint {
    /// The footprint of a surface in a world whose z axis points down; `None` for ground. For a steep plane it is its
    /// line at `height_m`.
    pub(super) fn of(form: &Form, height_m: f64) -> Option<Self> {
        match *form {
            Form::Plane { point_world, normal_world } => {
                let normal = normal_world.normalize_or_zero();
                let level = normal.truncate();
                if level.length() < STEEP {
                    return None;
                }
                let point = point_world.truncate()
                    + level * (normal.z * (height_m + point_world.z)) / level.length_squared();
                let along = level.perp().normalize() * FAR_M;
                Some(Self::Line([point - along, point + along]))
            }
            Form::Rectangle { centre_world, to_right, to_top } => {
                let corner = |right: f64, top: f64| centre_world + right * to_right + top * to_top;
                let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                Some(Self::hull(&corners))
            }
            Form::Cylinder { base_world, top_world, radius_m } => {
                let axis = top_world - base_world;
                if axis.truncate().length() <= 1e-9 * axis.length() {
                    return Some(Self::Circle(base_world.truncate(), radius_m));
                }
                let (u, v) = axis.normalize_or(DVec3::Z).any_orthonormal_pair();
                let rim = (0..AROUND).flat_map(|i| {
                    let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
                    [base_world, top_world].map(|end| end + radius_m * (cos * u + sin * v))
                });
                Some(Self::hull(&rim.collect::<Vec<_>>()))
            }
            Form::Cuboid { centre_world, world_from_box, edges_m } => {
                Some(Self::hull(&corners(centre_world, world_from_box, edges_m)))
            }
        }
    }

    /// Whether it may be nearer to a point than a distance. Conservative: it may return true wrongly.
    pub(super) fn is_near(&self, place: DVec2, distance_m: f64) -> bool {
        match self {
            Self::Circle(centre, radius_m) => centre.distance(place) <= distance_m + radius_m,
            Self::Line(ends) => {
                let along = (ends[1] - ends[0]).normalize_or_zero();
                let part = (place - ends[0]).dot(along).clamp(0.0, ends[0].distance(ends[1]));
                (ends[0] + part * along).distance(place) <= distance_m
            }
            Self::Polygon(corners) => {
                let middle = corners.iter().sum::<DVec2>() / corners.len().max(1) as f64;
                let reach = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
                middle.distance(place) <= distance_m + reach
            }
        }
    }

    /// The convex hull of points (A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions,
    /// Information Processing Letters 9, 1979); a line if all of them are collinear.
    fn hull(points: &[DVec3]) -> Self {
        let mut sorted: Vec<DVec2> = points.iter().map(|point| point.truncate()).collect();
        sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let extent = sorted.iter().map(|point| point.distance(sorted[0])).fold(0.0, f64::max);
        let least = 1e-9 * extent * extent;
        let half = |points: &mut dyn Iterator<Item = &DVec2>| {
            let mut half: Vec<DVec2> = Vec::new();
            for point in points {
                while let [.., a, b] = half[..] {
                    if (b - a).perp_dot(*point - b) > least {
                        break;
                    }
                    half.pop();
                }
                half.push(*point);
            }
            half.pop();
            half
        };
        let mut hull = half(&mut sorted.iter());
        hull.extend(half(&mut sorted.iter().rev()));
        match hull[..] {
            [a, b] => Self::Line([a, b]),
            _ => Self::Polygon(hull),
        }
    }
}

fn corners(centre: DVec3, world_from_box: DMat3, edges_m: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        centre + world_from_box * (edges_m * DVec3::new(sign(0), sign(1), sign(2)))
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sim::Surface;

    fn of(surface: crate::error::Result<Surface>) -> Option<Footprint> {
        Footprint::of(&surface.unwrap().form(), 10.0)
    }

    fn area(corners: &[DVec2]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        0.5 * corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>().abs()
    }

    #[test]
    fn each_form_has_its_own() {
        assert_eq!(of(Surface::plane(DVec3::ZERO, DVec3::NEG_Z)), None);
        let up = DVec3::NEG_Z;
        let trunk = of(Surface::cylinder(DVec3::new(3.0, 4.0, 0.0), DVec3::new(3.0, 4.0, -9.0), 0.3));
        assert_eq!(trunk, Some(Footprint::Circle(DVec2::new(3.0, 4.0), 0.3)));
        let Some(Footprint::Line(ends)) =
            of(Surface::rectangle(DVec3::new(5.0, 0.0, -4.0), DVec3::Y * 6.0, up * 4.0))
        else {
            panic!("an upright wall is a line")
        };
        assert!((ends[0].distance(ends[1]) - 12.0).abs() < 1e-9, "{ends:?}");
        let turn = DMat3::from_rotation_z(0.4);
        let Some(Footprint::Polygon(corners)) =
            of(Surface::cuboid(DVec3::new(1.0, 2.0, -5.0), turn, DVec3::new(3.0, 2.0, 10.0)))
        else {
            panic!("a box is a polygon")
        };
        assert_eq!(corners.len(), 4);
        assert!((area(&corners) - 6.0).abs() < 1e-9, "{corners:?}");
        // A log of 2 m by 1 m: its outline is a rectangle.
        let Some(Footprint::Polygon(log)) = of(Surface::cylinder(DVec3::ZERO, DVec3::X * 2.0, 0.5)) else {
            panic!("a lying cylinder is a polygon")
        };
        assert!((area(&log) - 2.0).abs() < 0.05, "{}", area(&log));
    }

    #[test]
    fn an_upright_plane_is_the_line_at_the_level_of_the_flight() {
        // It leans to the north with height: at 10 m it is 10 m further north.
        let Some(Footprint::Line(ends)) =
            of(Surface::plane(DVec3::new(50.0, 0.0, 0.0), DVec3::new(-1.0, 0.0, -1.0)))
        else {
            panic!("a steep plane is a line")
        };
        assert!(ends.iter().all(|end| (end.x - 60.0).abs() < 1e-6), "{ends:?}");
    }

    #[test]
    fn what_is_far_is_not_near() {
        let wall = Footprint::Line([DVec2::new(10.0, -100.0), DVec2::new(10.0, 100.0)]);
        assert!(wall.is_near(DVec2::new(5.0, 90.0), 6.0) && !wall.is_near(DVec2::ZERO, 9.0));
        let tree = Footprint::Circle(DVec2::new(0.0, 20.0), 1.0);
        assert!(tree.is_near(DVec2::ZERO, 19.5) && !tree.is_near(DVec2::ZERO, 18.5));
    }
}
