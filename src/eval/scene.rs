//! A synthetic scene whose flow is known exactly.

use rayon::prelude::*;

use crate::error::Result;
use crate::frame::{FlowField, Image, PixelFormat, Size};
use crate::kernels::hash::{finalised, scrambled};

/// Grid spacings of the texture's octaves in pixels. The finest keeps the texture below half the sampling rate.
const SPACINGS: [f64; 4] = [4.0, 8.0, 16.0, 32.0];
/// Amplitude of an octave, in gray levels.
const AMPLITUDE: f64 = 85.0;
/// Rotation of the background per frame, radians.
const ROTATION: f64 = 0.008;
/// Magnification of the background per frame.
const ZOOM: f64 = 1.008;

/// A textured background that rotates and approaches, and in front of it a textured disc that moves sideways.
///
/// Every frame is sampled from the scene itself, not from another frame, so the flow between two frames is known in
/// closed form, at any size.
#[derive(Clone, Debug)]
pub struct Scene {
    size: Size,
    centre: [f64; 2],
    disc: [f64; 2],
    radius: f64,
    velocity: [f64; 2],
}

impl Scene {
    /// The scene for frames of this size.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a size that is out of range.
    pub fn new(size: Size) -> Result<Self> {
        size.validate()?;
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        Ok(Self {
            size,
            centre: [(width - 1.0) / 2.0, (height - 1.0) / 2.0],
            disc: [0.3 * width, 0.6 * height],
            radius: 0.16 * width.min(height),
            velocity: [0.005 * width, -0.003 * width],
        })
    }

    /// Frame `number`, in gray.
    pub fn frame(&self, number: u32) -> Image {
        let width = self.size.width as usize;
        let mut data = vec![0; self.size.pixels()];
        data.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| {
            for (x, gray) in row.iter_mut().enumerate() {
                *gray = self.gray([x as f64, y as f64], f64::from(number)).round().clamp(0.0, 255.0) as u8;
            }
        });
        Image { size: self.size, format: PixelFormat::Gray8, data }
    }

    /// The true flow from frame `number` to the next: the displacement of the point that each pixel shows.
    pub fn flow(&self, number: u32) -> FlowField {
        let (sin, cos) = ROTATION.sin_cos();
        let [[a, b], [c, d]] = [[ZOOM * cos - 1.0, -ZOOM * sin], [ZOOM * sin, ZOOM * cos - 1.0]];
        let displacement = |at: [f64; 2]| {
            if self.distance_to_disc(at, f64::from(number)) < 0.0 {
                return self.velocity.map(|v| v as f32);
            }
            let [x, y] = [at[0] - self.centre[0], at[1] - self.centre[1]];
            [(a * x + b * y) as f32, (c * x + d * y) as f32]
        };
        let rows = 0..self.size.height;
        let pixels = rows.flat_map(|y| (0..self.size.width).map(move |x| [f64::from(x), f64::from(y)]));
        FlowField { size: self.size, data: pixels.map(displacement).collect() }
    }

    fn gray(&self, at: [f64; 2], time: f64) -> f64 {
        let (sin, cos) = (ROTATION * time).sin_cos();
        let shrink = ZOOM.powf(-time);
        let [x, y] = [at[0] - self.centre[0], at[1] - self.centre[1]];
        let behind = [shrink * (cos * x + sin * y), shrink * (cos * y - sin * x)];
        // The edge is a pixel wide, as a camera would show it.
        match (0.5 - self.distance_to_disc(at, time)).clamp(0.0, 1.0) {
            0.0 => texture(behind, 0),
            share => {
                let front = std::array::from_fn(|i| at[i] - self.disc[i] - time * self.velocity[i]);
                share * texture(front, 1) + (1.0 - share) * texture(behind, 0)
            }
        }
    }

    /// The distance to the disc's edge in pixels; negative on the disc.
    fn distance_to_disc(&self, at: [f64; 2], time: f64) -> f64 {
        let [x, y]: [f64; 2] = std::array::from_fn(|i| at[i] - self.disc[i] - time * self.velocity[i]);
        x.hypot(y) - self.radius
    }
}

/// The gray level of an endless texture: random values on grids, smoothed by a cubic B-spline.
fn texture([x, y]: [f64; 2], layer: u32) -> f64 {
    let octave = |(octave, spacing): (usize, f64)| {
        let (columns, rows) = (spline(x / spacing), spline(y / spacing));
        let mut sum = 0.0;
        for (j, row) in (rows.0 - 1..).zip(rows.1) {
            for (i, column) in (columns.0 - 1..).zip(columns.1) {
                sum += row * column * random(i, j, 8 * layer + octave as u32);
            }
        }
        sum
    };
    128.0 + AMPLITUDE * SPACINGS.into_iter().enumerate().map(octave).sum::<f64>()
}

/// The grid point at or before a position, and the weights of the four around it.
fn spline(at: f64) -> (i32, [f64; 4]) {
    let t = at - at.floor();
    let weights = [
        (1.0 - t).powi(3),
        3.0 * t.powi(3) - 6.0 * t * t + 4.0,
        -3.0 * t.powi(3) + 3.0 * t * t + 3.0 * t + 1.0,
        t.powi(3),
    ];
    (at.floor() as i32, weights.map(|weight| weight / 6.0))
}

/// A pseudorandom number from −1 to 1 that depends on the grid point alone, by the finaliser of MurmurHash3.
fn random(i: i32, j: i32, grid: u32) -> f64 {
    let hash = finalised(finalised(scrambled(grid) ^ i as u32) ^ j as u32);
    f64::from(hash) / f64::from(u32::MAX) * 2.0 - 1.0
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        Scene::new(Size::new(160, 120)).unwrap()
    }

    #[test]
    fn what_is_seen_at_a_pixel_is_seen_where_the_flow_leads() {
        let (scene, flow) = (scene(), scene().flow(3));
        let mut compared = 0;
        for (i, [u, v]) in flow.data.iter().enumerate() {
            let at = [(i % 160) as f64, (i / 160) as f64];
            let to = [at[0] + f64::from(*u), at[1] + f64::from(*v)];
            // Leave out the edge, where the disc covers and uncovers the background.
            if scene.distance_to_disc(at, 3.0).abs() > 1.0 && scene.distance_to_disc(to, 4.0).abs() > 1.0 {
                let covered = scene.distance_to_disc(at, 3.0) > 0.0 && scene.distance_to_disc(to, 4.0) < 0.0;
                if !covered {
                    compared += 1;
                    let (now, then) = (scene.gray(at, 3.0), scene.gray(to, 4.0));
                    assert!((now - then).abs() < 1e-3, "{now} {then} at {at:?}");
                }
            }
        }
        assert!(compared > 18_000, "{compared}");
    }

    #[test]
    fn the_texture_uses_the_range_and_does_not_repeat() {
        let image = scene().frame(0);
        let mean = image.data.iter().map(|v| f64::from(*v)).sum::<f64>() / image.data.len() as f64;
        let spread = image.data.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>();
        let deviation = (spread / image.data.len() as f64).sqrt();
        assert!((100.0..156.0).contains(&mean) && (30.0..70.0).contains(&deviation), "{mean} {deviation}");
        let clipped = image.data.iter().filter(|v| matches!(v, 0 | 255)).count();
        assert!(clipped * 50 < image.data.len(), "{clipped}");
        let rows: std::collections::HashSet<&[u8]> = image.data.chunks(160).collect();
        assert_eq!(rows.len(), 120);
    }

    #[test]
    fn frames_differ_and_are_the_same_twice() {
        assert_ne!(scene().frame(0), scene().frame(1));
        assert_eq!(scene().frame(5), scene().frame(5));
        assert_eq!(Scene::new(Size::new(1, 1)).unwrap().frame(0).data.len(), 1);
    }
}
