use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::Result;
use crate::frame::Size;

/// Side of the tiles: squares of pixels whose visible surfaces are determined together.
pub(super) const TILE: usize = 16;

/// The rays of a camera's pixels, through its lens. Created once per camera: it inverts the lens map at every pixel.
#[derive(Clone, Debug)]
pub struct RayTable {
    size: Size,
    /// Through the pixels' centres, row by row.
    centres: Vec<DVec3>,
    /// Through the pixels' corners, row by row: one more per row than pixels, and one more row.
    corners: Vec<DVec3>,
    /// Per tile, least and largest x/z, least and largest y/z.
    tiles: Vec<[f64; 4]>,
}

impl RayTable {
    /// The rays of a camera.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a size out of range.
    pub fn new(camera: &Camera) -> Result<Self> {
        let size = camera.size.validate()?;
        let (width, height) = (size.width as usize, size.height as usize);
        let grid = |columns: usize, rows: usize, shift: f64| -> Vec<DVec3> {
            let place = |i: usize| [(i % columns) as f64 - shift, (i / columns) as f64 - shift];
            let rays = (0..columns * rows).into_par_iter().map(|i| camera.ray(place(i)));
            rays.map(|ray| ray.unwrap_or(DVec3::NAN)).collect()
        };
        let (centres, corners) = (grid(width, height, 0.0), grid(width + 1, height + 1, 0.5));
        let mut table = Self { size, centres, corners, tiles: Vec::new() };
        let [across, down] = table.tiles_across_and_down();
        table.tiles = (0..across * down).map(|i| table.bounds(i % across, i / across)).collect();
        Ok(table)
    }

    /// Width and height of the camera's images.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The direction of a pixel's centre: a unit vector in the camera's frame. `None` where the lens map is not
    /// invertible at the centre or a corner of the pixel.
    ///
    /// # Panics
    /// If the pixel is outside the image.
    pub fn bearing(&self, x: u32, y: u32) -> Option<DVec3> {
        assert!(x < self.size.width && y < self.size.height, "pixel {x}, {y} of {}", self.size);
        let centre = self.centre(x as usize, y as usize);
        let corners = self.corners(x as usize, y as usize);
        (centre.is_finite() && corners.iter().all(|corner| corner.is_finite())).then_some(centre)
    }

    pub(super) fn centre(&self, x: usize, y: usize) -> DVec3 {
        self.centres[y * self.size.width as usize + x]
    }

    pub(super) fn corner(&self, x: usize, y: usize) -> DVec3 {
        self.corners[y * (self.size.width as usize + 1) + x]
    }

    /// Top left, top right, bottom left, bottom right.
    pub(super) fn corners(&self, x: usize, y: usize) -> [DVec3; 4] {
        [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].map(|(x, y)| self.corner(x, y))
    }

    pub(super) fn tiles_across_and_down(&self) -> [usize; 2] {
        [self.size.width as usize, self.size.height as usize].map(|side| side.div_ceil(TILE))
    }

    /// Normals of the four planes through the camera that have all rays of a tile on their positive side.
    pub(super) fn sides(&self, tile_x: usize, tile_y: usize) -> [DVec3; 4] {
        let [x0, x1, y0, y1] = self.tiles[tile_y * self.tiles_across_and_down()[0] + tile_x];
        [
            DVec3::new(1.0, 0.0, -x0),
            DVec3::new(-1.0, 0.0, x1),
            DVec3::new(0.0, 1.0, -y0),
            DVec3::new(0.0, -1.0, y1),
        ]
    }

    fn bounds(&self, tile_x: usize, tile_y: usize) -> [f64; 4] {
        let end = |tile: usize, side: u32| ((tile + 1) * TILE).min(side as usize);
        let mut bounds = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for y in tile_y * TILE..=end(tile_y, self.size.height) {
            for x in tile_x * TILE..=end(tile_x, self.size.width) {
                let ray = self.corner(x, y);
                // min and max ignore NaN.
                for (i, tangent) in [ray.x / ray.z, ray.y / ray.z].into_iter().enumerate() {
                    bounds[2 * i] = bounds[2 * i].min(tangent);
                    bounds[2 * i + 1] = bounds[2 * i + 1].max(tangent);
                }
            }
        }
        bounds
    }
}
