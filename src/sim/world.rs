use glam::DVec3;

use super::Surface;
use super::texture;
use crate::kernels::shade::{LIGHT, SKY};

/// Surfaces under a sky.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// The surfaces. A surface's index is part of its texture.
    pub surfaces: Vec<Surface>,
    /// The direction in which the sky is brightest: a unit vector.
    pub up_world: DVec3,
}

/// The first intersection of a ray with a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The distance from the ray's origin, metres.
    pub distance_m: f64,
    /// The surface's unit normal, on the side of the ray's origin.
    pub normal_world: DVec3,
    /// The index of the surface in [`World::surfaces`].
    pub surface: usize,
    /// The face: 0 for planes and rectangles, 0 for a cylinder's mantle and 1 and 2 for its lids, 0 to 5 for a box.
    pub face: u32,
    /// The position on that face, in metres along it.
    pub uv_m: [f64; 2],
}

impl World {
    /// A world of these surfaces in which up is against y, as for a camera without rotation.
    pub fn new(surfaces: Vec<Surface>) -> Self {
        Self { surfaces, up_world: DVec3::NEG_Y }
    }

    /// The first intersection with a ray of unit direction; `None` is the sky.
    pub fn hit(&self, origin_world: DVec3, direction_world: DVec3) -> Option<Hit> {
        self.hit_among(0..self.surfaces.len(), origin_world, direction_world)
    }

    /// Like [`World::hit`], if only some surfaces can be met.
    pub(super) fn hit_among(
        &self,
        surfaces: impl Iterator<Item = usize>,
        origin_world: DVec3,
        direction_world: DVec3,
    ) -> Option<Hit> {
        let mut first: Option<Hit> = None;
        for surface in surfaces {
            let Some(hit) = self.surfaces[surface].hit(origin_world, direction_world) else { continue };
            if first.is_none_or(|first| hit.distance_m < first.distance_m) {
                first = Some(Hit {
                    distance_m: hit.distance_m,
                    normal_world: hit.normal_world,
                    surface,
                    face: hit.face,
                    uv_m: hit.uv_m,
                });
            }
        }
        first
    }

    /// The gray level, 0 to 255, of a ray's intersection, for a pixel that is `pixel_rad` wide.
    pub fn gray(&self, hit: Option<&Hit>, direction_world: DVec3, pixel_rad: f64) -> f64 {
        let [horizon, zenith] = SKY.map(f64::from);
        let gray = match hit {
            None => horizon + zenith * direction_world.dot(self.up_world),
            Some(hit) => {
                let slant = hit.normal_world.dot(direction_world).abs();
                // A pixel covers a length of its width across the slant and more along it. Use a length between the
                // two: the longer one would blur too much, the shorter one would alias.
                let across_m = hit.distance_m * pixel_rad;
                let footprint_log2_m = (across_m.powi(3) / (slant * slant)).log2() / 3.0;
                let seed = 8 * hit.surface as u32 + hit.face;
                let period_m = self.surfaces[hit.surface].period_m(hit.face);
                let light = 1.0 + f64::from(LIGHT) * hit.normal_world.dot(self.up_world);
                light * texture::gray(hit.uv_m, period_m, seed, footprint_log2_m)
            }
        };
        gray.clamp(0.0, 255.0)
    }
}
