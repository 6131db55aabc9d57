//! Surfaces, and their intersections with rays. Each shape has a frame of its own, in which it is simplest.

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};

/// A textured surface of a [`World`](super::World). All lengths are in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    pub(super) origin_world: DVec3,
    pub(super) local_from_world: DMat3,
    pub(super) shape: Geometry,
    /// The radius of the bounding sphere around its origin.
    pub(super) reach_m: f64,
    form: Form,
}

/// The definition of a [`Surface`]: the arguments of its constructor, as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// The arguments of [`Surface::plane`].
    Plane {
        /// Any point of the plane, metres.
        point_world: DVec3,
        /// The normal, of any length.
        normal_world: DVec3,
    },
    /// The arguments of [`Surface::rectangle`].
    Rectangle {
        /// The centre, metres.
        centre_world: DVec3,
        /// From the centre to the middle of an edge, metres.
        to_right: DVec3,
        /// The same, to an edge at a right angle.
        to_top: DVec3,
    },
    /// The arguments of [`Surface::cylinder`].
    Cylinder {
        /// Centre of one lid, metres.
        base_world: DVec3,
        /// Centre of the other lid, metres.
        top_world: DVec3,
        /// The radius, metres.
        radius_m: f64,
    },
    /// The arguments of [`Surface::cuboid`].
    Cuboid {
        /// The centre, metres.
        centre_world: DVec3,
        /// The rotation from the box's frame; its columns are the directions of the edges.
        world_from_box: DMat3,
        /// Full edge lengths, metres.
        edges_m: DVec3,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Geometry {
    /// z = 0, infinite.
    Plane,
    /// z = 0 between ±half.
    Rectangle { half_m: [f64; 2] },
    /// Around z, from 0 to its length, with two lids.
    Cylinder { radius_m: f64, length_m: f64 },
    /// Between ±half.
    Cuboid { half_m: DVec3 },
}

impl Geometry {
    /// Whether part of the shape may lie where `normal` · point + `offset_m` ≥ 0, in its own frame. Conservative: it
    /// may return true wrongly.
    pub(super) fn reaches(&self, normal: DVec3, offset_m: f64) -> bool {
        let n = normal;
        let beyond_m = match *self {
            Self::Plane => return true,
            Self::Rectangle { half_m: [a, b] } => n.x.abs() * a + n.y.abs() * b,
            Self::Cylinder { radius_m, length_m } => {
                radius_m * (n.x * n.x + n.y * n.y).sqrt() + (n.z * length_m).max(0.0)
            }
            Self::Cuboid { half_m } => n.abs().dot(half_m),
        };
        // The margin covers the rounding of the normal.
        offset_m + beyond_m >= -1e-9 * (1.0 + beyond_m)
    }
}

/// The intersection of a ray and a shape, in the shape's frame.
struct Met {
    distance_m: f64,
    normal: DVec3,
    face: u32,
    uv_m: [f64; 2],
}

/// The intersection of a ray and a surface.
pub(super) struct SurfaceHit {
    pub(super) distance_m: f64,
    /// Towards the ray's origin.
    pub(super) normal_world: DVec3,
    pub(super) face: u32,
    pub(super) uv_m: [f64; 2],
}

impl Surface {
    /// An infinite plane. Its normal points to the free side; the other side is solid.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a point that is not finite, or a zero normal.
    pub fn plane(point_world: DVec3, normal_world: DVec3) -> Result<Self> {
        let normal = direction("plane normal", normal_world)?;
        let (u, v) = normal.any_orthonormal_pair();
        let form = Form::Plane { point_world, normal_world };
        Self::new(point_world, DMat3::from_cols(u, v, normal), Geometry::Plane, form)
    }

    /// A rectangle, visible from both sides. `to_right` and `to_top` lead from its centre to the middles of two
    /// edges.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the two are not at a right angle, or of length 0.
    pub fn rectangle(centre_world: DVec3, to_right: DVec3, to_top: DVec3) -> Result<Self> {
        let (u, v) = (direction("rectangle side", to_right)?, direction("rectangle side", to_top)?);
        if !(u.dot(v).abs() <= 1e-6) {
            return Err(Error::parameter(
                "rectangle sides",
                format!("{to_right} and {to_top}"),
                "a right angle",
            ));
        }
        let normal = u.cross(v).normalize();
        let half_m = [to_right.length(), to_top.length()];
        let form = Form::Rectangle { centre_world, to_right, to_top };
        let world_from_local = DMat3::from_cols(u, normal.cross(u), normal);
        Self::new(centre_world, world_from_local, Geometry::Rectangle { half_m }, form)
    }

    /// A cylinder with lids, from the centre of one to that of the other.
    ///
    /// # Errors
    /// [`Error::Parameter`] for coinciding points, or a radius that is not above 0.
    pub fn cylinder(base_world: DVec3, top_world: DVec3, radius_m: f64) -> Result<Self> {
        let axis = direction("cylinder axis", top_world - base_world)?;
        let (u, v) = axis.any_orthonormal_pair();
        let length_m = (top_world - base_world).length();
        positive("cylinder radius", radius_m)?;
        let form = Form::Cylinder { base_world, top_world, radius_m };
        Self::new(base_world, DMat3::from_cols(u, v, axis), Geometry::Cylinder { radius_m, length_m }, form)
    }

    /// A box of these edge lengths, oriented by a rotation.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a matrix that is not a rotation, or a length that is not above 0.
    pub fn cuboid(centre_world: DVec3, world_from_box: DMat3, edges_m: DVec3) -> Result<Self> {
        edges_m.to_array().into_iter().try_for_each(|edge| positive("box edge", edge))?;
        let off = (world_from_box * world_from_box.transpose() - DMat3::IDENTITY).to_cols_array();
        if !off.iter().all(|e| e.abs() <= 1e-9) {
            return Err(Error::parameter("world_from_box", world_from_box, "a rotation"));
        }
        let form = Form::Cuboid { centre_world, world_from_box, edges_m };
        Self::new(centre_world, world_from_box, Geometry::Cuboid { half_m: edges_m / 2.0 }, form)
    }

    /// The definition of the surface.
    pub fn form(&self) -> Form {
        self.form
    }

    fn new(origin_world: DVec3, world_from_local: DMat3, shape: Geometry, form: Form) -> Result<Self> {
        if !origin_world.is_finite() {
            return Err(Error::parameter("position of a surface", origin_world, "three finite coordinates"));
        }
        let reach_m = match shape {
            Geometry::Plane => f64::INFINITY,
            Geometry::Rectangle { half_m: [a, b] } => a.hypot(b),
            Geometry::Cylinder { radius_m, length_m } => radius_m.hypot(length_m),
            Geometry::Cuboid { half_m } => half_m.length(),
        };
        Ok(Self { origin_world, local_from_world: world_from_local.transpose(), shape, reach_m, form })
    }

    /// The period of the texture along u, if u runs around the surface.
    pub(super) fn period_m(&self, face: u32) -> Option<f64> {
        match self.shape {
            Geometry::Cylinder { radius_m, .. } if face == 0 => Some(std::f64::consts::TAU * radius_m),
            _ => None,
        }
    }

    /// Whether part of the surface may lie where `normal_world` · (point − `origin_world`) ≥ 0. Conservative: it may
    /// return true wrongly.
    pub(super) fn reaches(&self, origin_world: DVec3, normal_world: DVec3) -> bool {
        let offset_m = normal_world.dot(self.origin_world - origin_world);
        self.shape.reaches(self.local_from_world * normal_world, offset_m)
    }

    /// The first intersection with a ray of unit direction.
    pub(super) fn hit(&self, origin_world: DVec3, direction_world: DVec3) -> Option<SurfaceHit> {
        let o = self.local_from_world * (origin_world - self.origin_world);
        let d = self.local_from_world * direction_world;
        let met = match self.shape {
            Geometry::Plane => flat(o, d, 0.0, 0),
            Geometry::Rectangle { half_m: [a, b] } => {
                flat(o, d, 0.0, 0).filter(|met| met.uv_m[0].abs() <= a && met.uv_m[1].abs() <= b)
            }
            Geometry::Cylinder { radius_m, length_m } => cylinder(o, d, radius_m, length_m),
            Geometry::Cuboid { half_m } => cuboid(o, d, half_m),
        }?;
        let normal = if met.normal.dot(d) > 0.0 { -met.normal } else { met.normal };
        let normal_world = self.local_from_world.transpose() * normal;
        Some(SurfaceHit { distance_m: met.distance_m, normal_world, face: met.face, uv_m: met.uv_m })
    }
}

fn direction(name: &'static str, vector: DVec3) -> Result<DVec3> {
    vector.try_normalize().ok_or_else(|| Error::parameter(name, vector, "a finite vector that is not 0"))
}

fn positive(name: &'static str, length_m: f64) -> Result<()> {
    if length_m > 0.0 && length_m.is_finite() {
        return Ok(());
    }
    Err(Error::parameter(name, length_m, "above 0 m and finite"))
}

/// The intersection with the plane of constant z.
fn flat(o: DVec3, d: DVec3, z_m: f64, face: u32) -> Option<Met> {
    let distance_m = (z_m - o.z) / d.z;
    let at = o + distance_m * d;
    let met = distance_m > 0.0 && at.is_finite();
    met.then_some(Met { distance_m, normal: DVec3::Z, face, uv_m: [at.x, at.y] })
}

fn cylinder(o: DVec3, d: DVec3, radius_m: f64, length_m: f64) -> Option<Met> {
    let a = d.x * d.x + d.y * d.y;
    let b = o.x * d.x + o.y * d.y;
    let c = o.x * o.x + o.y * o.y - radius_m * radius_m;
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        // A ray that misses the infinite cylinder misses the lids.
        return None;
    }
    // One root from the sum without cancellation, the other from the product of the roots.
    let q = -b - discriminant.sqrt().copysign(b);
    let (one, other) = (q / a, c / q);
    let side = |distance_m: f64| {
        let at = o + distance_m * d;
        let met = distance_m > 0.0 && (0.0..=length_m).contains(&at.z);
        let uv_m = [at.y.atan2(at.x) * radius_m, at.z];
        met.then_some(Met { distance_m, normal: DVec3::new(at.x, at.y, 0.0) / radius_m, face: 0, uv_m })
    };
    let lid = |z_m, face| flat(o, d, z_m, face).filter(|met| met.uv_m[0].hypot(met.uv_m[1]) <= radius_m);
    let first_side = side(one.min(other)).or_else(|| side(one.max(other)));
    [first_side, lid(0.0, 1), lid(length_m, 2)].into_iter().flatten().min_by(by_distance)
}

fn by_distance(a: &Met, b: &Met) -> std::cmp::Ordering {
    a.distance_m.total_cmp(&b.distance_m)
}

fn cuboid(o: DVec3, d: DVec3, half_m: DVec3) -> Option<Met> {
    // Distance and axis at which the ray enters the last of the three slabs, and at which it leaves the first.
    let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if !(o[axis].abs() <= half_m[axis]) {
                return None;
            }
            continue;
        }
        let side = half_m[axis].copysign(d[axis]);
        let (near, far) = ((-side - o[axis]) / d[axis], (side - o[axis]) / d[axis]);
        if near > enter.0 {
            enter = (near, axis);
        }
        if far < leave.0 {
            leave = (far, axis);
        }
    }
    if !(enter.0 <= leave.0 && leave.0 > 0.0) {
        return None;
    }
    // From inside, the far face is visible.
    let ((distance_m, axis), outside) = if enter.0 > 0.0 { (enter, true) } else { (leave, false) };
    let at = o + distance_m * d;
    let positive_face = (d[axis] > 0.0) != outside;
    let uv_m = [at[(axis + 1) % 3], at[(axis + 2) % 3]];
    let face = 2 * axis as u32 + u32::from(positive_face);
    distance_m.is_finite().then_some(Met { distance_m, normal: DVec3::AXES[axis], face, uv_m })
}
