use glam::DVec3;
use rayon::prelude::*;

use super::rays::TILE;
use super::{Hit, RayTable, World};
use crate::camera::Pose;
use crate::frame::{Image, PixelFormat, Plane};

/// Samples along each side of a pixel that shows more than one surface.
const SAMPLES: usize = 4;
/// Corners along the side of a tile.
const CORNERS: usize = TILE + 1;

/// A rendered image, and its nearness.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// Gray, 8 bits. Black where the lens shows nothing.
    pub image: Image,
    /// The inverse distance along each pixel's central ray, 1/m: 0 for the sky, NaN where the lens shows nothing.
    pub nearness_per_m: Plane,
}

/// Renders a world from a pose.
///
/// A pixel whose corners all show the surface at its centre has the texture's value there, which is band-limited to
/// the size of a pixel; any other is the mean of 16 samples. Objects thinner than half a pixel may be missed.
pub fn reference_render(world: &World, rays: &RayTable, pose: &Pose) -> Rendering {
    let size = rays.size();
    let width = size.width as usize;
    let mut image = Image { size, format: PixelFormat::Gray8, data: vec![0; size.pixels()] };
    let mut nearness_per_m = Plane { size, data: vec![0.0; size.pixels()] };
    let bands = image.data.par_chunks_mut(width * TILE).zip(nearness_per_m.data.par_chunks_mut(width * TILE));
    bands.enumerate().for_each(|(tile_y, (gray, nearness))| {
        for tile_x in 0..width.div_ceil(TILE) {
            let tile = Tile::new(world, rays, pose, [tile_x, tile_y]);
            for (row, gray) in gray.chunks_exact_mut(width).enumerate() {
                for x in tile_x * TILE..((tile_x + 1) * TILE).min(width) {
                    let seen = tile.pixel(x, tile_y * TILE + row);
                    (gray[x], nearness[row * width + x]) = (seen.0.round() as u8, seen.1 as f32);
                }
            }
        }
    });
    Rendering { image, nearness_per_m }
}

/// The nearness of [`reference_render`], without the image.
pub fn nearness(world: &World, rays: &RayTable, pose: &Pose) -> Plane {
    let size = rays.size();
    let width = size.width as usize;
    let mut plane = Plane { size, data: vec![0.0; size.pixels()] };
    plane.data.par_chunks_mut(width * TILE).enumerate().for_each(|(tile_y, band)| {
        for tile_x in 0..width.div_ceil(TILE) {
            let surfaces = reached(world, rays, pose, [tile_x, tile_y]);
            for (row, values) in band.chunks_exact_mut(width).enumerate() {
                for (x, value) in values.iter_mut().enumerate().skip(tile_x * TILE).take(TILE) {
                    let direction = pose.world_from_camera * rays.centre(x, tile_y * TILE + row);
                    let hit = world.hit_among(surfaces.iter().copied(), pose.position_world, direction);
                    let nearness = hit.map_or(0.0, |hit| 1.0 / hit.distance_m);
                    *value = if direction.is_finite() { nearness as f32 } else { f32::NAN };
                }
            }
        }
    });
    plane
}

/// The surfaces that may be visible in a tile.
pub(super) fn reached(
    world: &World,
    rays: &RayTable,
    pose: &Pose,
    [tile_x, tile_y]: [usize; 2],
) -> Vec<usize> {
    let sides = rays.sides(tile_x, tile_y).map(|side| pose.world_from_camera * side);
    let within = |i: &usize| sides.iter().all(|side| world.surfaces[*i].reaches(pose.position_world, *side));
    (0..world.surfaces.len()).filter(within).collect()
}

/// A square of pixels, and the surfaces that may be visible in it.
struct Tile<'a> {
    world: &'a World,
    rays: &'a RayTable,
    pose: &'a Pose,
    first: [usize; 2],
    surfaces: Vec<usize>,
    corners: [[Option<(usize, u32)>; CORNERS]; CORNERS],
}

impl<'a> Tile<'a> {
    fn new(world: &'a World, rays: &'a RayTable, pose: &'a Pose, tile: [usize; 2]) -> Self {
        let surfaces = reached(world, rays, pose, tile);
        let first = tile.map(|tile| tile * TILE);
        let mut tile = Self { world, rays, pose, first, surfaces, corners: [[None; CORNERS]; CORNERS] };
        let (width, height) = (rays.size().width as usize, rays.size().height as usize);
        for y in first[1]..=(first[1] + TILE).min(height) {
            for x in first[0]..=(first[0] + TILE).min(width) {
                let hit = tile.hit(pose.world_from_camera * rays.corner(x, y));
                tile.corners[y - first[1]][x - first[0]] = hit.as_ref().map(side_of);
            }
        }
        tile
    }

    fn hit(&self, direction_world: DVec3) -> Option<Hit> {
        self.world.hit_among(self.surfaces.iter().copied(), self.pose.position_world, direction_world)
    }

    /// Gray level and nearness.
    fn pixel(&self, x: usize, y: usize) -> (f64, f64) {
        let corners = self.rays.corners(x, y);
        let centre = self.rays.centre(x, y);
        let pixel_rad = (0.5 * (corners[3] - corners[0]).cross(corners[2] - corners[1]).length()).sqrt();
        if !(centre.is_finite() && pixel_rad.is_finite()) {
            return (0.0, f64::NAN);
        }
        let direction = self.pose.world_from_camera * centre;
        let hit = self.hit(direction);
        let nearness = hit.map_or(0.0, |hit| 1.0 / hit.distance_m);
        let (i, j) = (x - self.first[0], y - self.first[1]);
        let around =
            [self.corners[j][i], self.corners[j][i + 1], self.corners[j + 1][i], self.corners[j + 1][i + 1]];
        if around.iter().all(|side| *side == hit.as_ref().map(side_of)) {
            return (self.world.gray(hit.as_ref(), direction, pixel_rad), nearness);
        }
        let mut sum = 0.0;
        for row in 0..SAMPLES {
            for column in 0..SAMPLES {
                let [s, t] = [column, row].map(|i| (i as f64 + 0.5) / SAMPLES as f64);
                let ray = corners[0].lerp(corners[1], s).lerp(corners[2].lerp(corners[3], s), t).normalize();
                let direction = self.pose.world_from_camera * ray;
                sum += self.world.gray(self.hit(direction).as_ref(), direction, pixel_rad);
            }
        }
        (sum / (SAMPLES * SAMPLES) as f64, nearness)
    }
}

/// The face that a ray meets: hits of the same face have no edge in between.
fn side_of(hit: &Hit) -> (usize, u32) {
    (hit.surface, hit.face)
}
