//! Undistorted frames, for display.

use super::draw::luma;
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::frame::{Frame, Image, Size};

/// The map from each pixel of the ideal image to its position in the raw frame.
#[derive(Debug)]
pub(super) struct Rectified {
    raw: Size,
    /// One position `[column, row]` per pixel, row by row; NaN where the raw frame does not show it.
    places: Vec<[f32; 2]>,
}

impl Rectified {
    pub(super) fn new(raw: &Camera, ideal: &Camera) -> Self {
        let same = raw == ideal;
        let place = |pixel: [f64; 2]| match same {
            true => Some(pixel),
            false => raw.project(ideal.ray(pixel)?),
        };
        let narrow = |place: [f64; 2]| place.map(|c| c as f32);
        let places = pixels(ideal).map(|pixel| place(pixel).map_or([f32::NAN; 2], narrow)).collect();
        Self { raw: raw.size, places }
    }

    /// Draws the undistorted frame in gray to an image of [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8);
    /// black where the raw frame does not show it.
    pub(super) fn draw(&self, frame: &Frame<'_>, image: &mut Image) -> Result<()> {
        if frame.size() != self.raw {
            let what = "frame".to_owned();
            return Err(Error::SizeMismatch { what, found: frame.size(), expected: self.raw });
        }
        let (gray, width, height) = (luma(frame), self.raw.width as usize, self.raw.height as usize);
        let at = |x: usize, y: usize| f32::from(gray[y.min(height - 1) * width + x.min(width - 1)]);
        for (pixel, &[u, v]) in image.data.as_chunks_mut::<3>().0.iter_mut().zip(&self.places) {
            let inside =
                (-0.5..=width as f32 - 0.5).contains(&u) && (-0.5..=height as f32 - 0.5).contains(&v);
            *pixel = [0; 3];
            if inside {
                let (u, v) = (u.max(0.0), v.max(0.0));
                let (x, y) = (u as usize, v as usize);
                let (right, down) = (u - x as f32, v - y as f32);
                let row = |y| (1.0 - right) * at(x, y) + right * at(x + 1, y);
                *pixel = [((1.0 - down) * row(y) + down * row(y + 1)).round() as u8; 3];
            }
        }
        Ok(())
    }
}

/// The centres of a camera's pixels, row by row.
pub(super) fn pixels(camera: &Camera) -> impl Iterator<Item = [f64; 2]> + use<> {
    let size = camera.size;
    (0..size.height).flat_map(move |v| (0..size.width).map(move |u| [f64::from(u), f64::from(v)]))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::camera::{Framing, Lens};
    use crate::frame::PixelFormat;

    const SIZE: Size = Size::new(200, 150);

    #[test]
    fn the_picture_is_that_of_the_ideal_camera() {
        let lens = Lens::new(&[-0.2, 0.03, 0.0, 0.0]).unwrap();
        let raw = Camera { size: SIZE, f_u: 100.0, f_v: 100.0, u_0: 99.5, v_0: 74.5, lens };
        let ideal = raw.ideal(SIZE, Framing::KeepAll).unwrap();
        let shade = |pixel: [f64; 2]| raw.ray(pixel).map(|ray| 120.0 + 50.0 * ray.x + 40.0 * ray.y);
        let data: Vec<u8> = pixels(&raw).map(|pixel| shade(pixel).unwrap().round() as u8).collect();
        let frame = Frame::new(SIZE, PixelFormat::Gray8, &data).unwrap();
        let mut image = Image { size: SIZE, format: PixelFormat::Rgb8, data: vec![9; 3 * SIZE.pixels()] };
        Rectified::new(&raw, &ideal).draw(&frame, &mut image).unwrap();
        let mut outside = 0;
        for (pixel, found) in pixels(&ideal).zip(image.data.as_chunks::<3>().0) {
            let ray = ideal.ray(pixel).unwrap();
            match raw.project(ray) {
                Some([u, v]) if (0.0..=199.0).contains(&u) && (0.0..=149.0).contains(&v) => {
                    let expected = 120.0 + 50.0 * ray.x + 40.0 * ray.y;
                    assert!((f64::from(found[0]) - expected).abs() <= 1.1, "{pixel:?} {found:?} {expected}");
                }
                _ => outside += usize::from(*found == [0; 3]),
            }
        }
        assert!(outside > 100, "{outside}");
    }
}
