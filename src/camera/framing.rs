//! Cameras derived from others: of a resized image, of a part of an image, and the ideal camera of an undistorted
//! image.

use super::{Camera, Lens};
use crate::error::{Error, Result};
use crate::frame::Size;

/// How much of the original image an ideal camera shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// Every pixel of the original, with borders that it does not show (OpenCV's `alpha` of 1).
    KeepAll,
    /// Only points that the original shows (OpenCV's `alpha` of 0).
    CropToValid,
}

impl Camera {
    /// The camera of the same image scaled to another size: its outer edges stay in place, not its outermost pixel
    /// centres.
    pub fn resized(&self, size: Size) -> Self {
        let along = |f: f64, c: f64, from: u32, to: u32| {
            let scale = f64::from(to) / f64::from(from);
            (f * scale, (c + 0.5) * scale - 0.5)
        };
        let (f_u, u_0) = along(self.f_u, self.u_0, self.size.width, size.width);
        let (f_v, v_0) = along(self.f_v, self.v_0, self.size.height, size.height);
        Self { size, f_u, f_v, u_0, v_0, lens: self.lens }
    }

    /// The camera of the part of the image that starts at column `x` and row `y`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the part is empty or extends beyond the image.
    pub fn cropped(&self, x: u32, y: u32, size: Size) -> Result<Self> {
        size.validate()?;
        let fits = |at: u32, part: u32, whole: u32| at.checked_add(part).is_some_and(|end| end <= whole);
        if !(fits(x, size.width, self.size.width) && fits(y, size.height, self.size.height)) {
            let part = format_args!("{size} at {x}, {y}").to_string();
            return Err(Error::parameter("part", part, format_args!("one inside {}", self.size)));
        }
        Ok(Self { size, u_0: self.u_0 - f64::from(x), v_0: self.v_0 - f64::from(y), ..*self })
    }

    /// The ideal camera, without distortion, whose image of the given size shows the view of this one.
    ///
    /// As OpenCV's `getOptimalNewCameraMatrix`, but with every pixel of the border instead of a few. The view fills
    /// the image, so the focal lengths along rows and columns may differ.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the size is out of range, or if the lens map is not invertible at some pixel of the
    /// border.
    pub fn ideal(&self, size: Size, view: Framing) -> Result<Self> {
        size.validate()?;
        let border = self.ideal_border()?;
        let [(left, most_left), (right, most_right)] = ends(&border.left, &border.right, 0);
        let [(top, most_top), (bottom, most_bottom)] = ends(&border.top, &border.bottom, 1);
        let [x, y] = match view {
            Framing::CropToValid => [[left, right], [top, bottom]],
            Framing::KeepAll => [[most_left, most_right], [most_top, most_bottom]],
        };
        let fit = |[low, high]: [f64; 2], pixels: u32| {
            // A single pixel has no distance between centres.
            let f = f64::from(pixels.max(2) - 1) / (high - low);
            (f, -f * low)
        };
        let ((f_u, u_0), (f_v, v_0)) = (fit(x, size.width), fit(y, size.height));
        if !(f_u > 0.0 && f_v > 0.0 && f_u.is_finite() && f_v.is_finite()) {
            let [across, down] = [x[1] - x[0], y[1] - y[0]];
            let found = format_args!(
                "{} with a lens that leaves a rectangle of {across:.3} × {down:.3} focal lengths of it",
                self.size
            );
            return Err(Error::parameter("size", found, "one with both above 0"));
        }
        Ok(Self { size, f_u, f_v, u_0, v_0, lens: Lens::NONE })
    }

    /// The undistorted positions of the border's pixels, at focal length 1.
    fn ideal_border(&self) -> Result<Border> {
        let Size { width, height } = self.size;
        let place = |u: u32, v: u32| {
            let pixel = [f64::from(u), f64::from(v)];
            self.ideal_place(pixel).ok_or_else(|| {
                let expected = "a lens with an inverse in the whole image";
                Error::parameter("pixel without a ray", format_args!("{u}, {v}"), expected)
            })
        };
        let column = |u: u32| (0..height).map(|v| place(u, v)).collect::<Result<Vec<_>>>();
        let row = |v: u32| (0..width).map(|u| place(u, v)).collect::<Result<Vec<_>>>();
        // Between the centres of a single column there is nothing to show.
        if width < 2 || height < 2 {
            return Err(Error::parameter("size", self.size, "at least 2×2, for a view without the lens"));
        }
        Ok(Border { left: column(0)?, right: column(width - 1)?, top: row(0)?, bottom: row(height - 1)? })
    }

    /// The undistorted position of a pixel, at focal length 1: (X/Z, Y/Z).
    pub(super) fn ideal_place(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        self.lens.undistort([(pixel[0] - self.u_0) / self.f_u, (pixel[1] - self.v_0) / self.f_v])
    }
}

struct Border {
    left: Vec<[f64; 2]>,
    right: Vec<[f64; 2]>,
    top: Vec<[f64; 2]>,
    bottom: Vec<[f64; 2]>,
}

/// The innermost and the outermost coordinate of the low side, then of the high side.
fn ends(low: &[[f64; 2]], high: &[[f64; 2]], axis: usize) -> [(f64, f64); 2] {
    let fold =
        |side: &[[f64; 2]], start: f64, f: fn(f64, f64) -> f64| side.iter().map(|p| p[axis]).fold(start, f);
    [
        (fold(low, f64::NEG_INFINITY, f64::max), fold(low, f64::INFINITY, f64::min)),
        (fold(high, f64::INFINITY, f64::min), fold(high, f64::NEG_INFINITY, f64::max)),
    ]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn camera() -> Camera {
        let lens = Lens::new(&[-0.28, 0.07, 2e-4, 2e-5]).unwrap();
        Camera { size: Size::new(752, 480), f_u: 458.0, f_v: 457.0, u_0: 367.0, v_0: 248.0, lens }
    }

    #[test]
    fn half_the_size_has_its_pixels_between_the_old_ones() {
        let (camera, half) = (camera(), camera().resized(Size::new(376, 240)));
        let point = DVec3::new(0.3, -0.2, 1.0);
        let ([u, v], [half_u, half_v]) = (camera.project(point).unwrap(), half.project(point).unwrap());
        // Old columns 0 and 1 are the new column 0.
        assert!(((u - 0.5) / 2.0 - half_u).abs() <= 1e-12 && ((v - 0.5) / 2.0 - half_v).abs() <= 1e-12);
    }

    #[test]
    fn a_part_has_its_own_first_pixel() {
        let part = camera().cropped(100, 50, Size::new(200, 100)).unwrap();
        let [a, b] = [part.ray([0.0, 0.0]).unwrap(), camera().ray([100.0, 50.0]).unwrap()];
        assert!(a.abs_diff_eq(b, 1e-15));
        let text = camera().cropped(600, 0, Size::new(200, 100)).unwrap_err().to_string();
        assert_eq!(text, "part is 200×100 at 600, 0, expected one inside 752×480");
        assert!(camera().cropped(u32::MAX, 0, Size::new(1, 1)).is_err());
    }

    #[test]
    fn one_view_keeps_every_pixel_and_the_other_only_what_is_shown() {
        let camera = camera();
        let inside = |camera: &Camera, [u, v]: [f64; 2]| {
            let most = [camera.size.width - 1, camera.size.height - 1].map(f64::from);
            let slack = 1e-9;
            u >= -slack && v >= -slack && u <= most[0] + slack && v <= most[1] + slack
        };
        let corners = |size: Size| {
            let [u, v] = [size.width - 1, size.height - 1].map(f64::from);
            [[0.0, 0.0], [u, 0.0], [0.0, v], [u, v], [u / 2.0, 0.0], [0.0, v / 2.0]]
        };
        let all = camera.ideal(Size::new(800, 600), Framing::KeepAll).unwrap();
        for pixel in corners(camera.size) {
            assert!(inside(&all, all.project(camera.ray(pixel).unwrap()).unwrap()), "{pixel:?}");
        }
        let crop = camera.ideal(Size::new(800, 600), Framing::CropToValid).unwrap();
        for pixel in corners(crop.size) {
            assert!(inside(&camera, camera.project(crop.ray(pixel).unwrap()).unwrap()), "{pixel:?}");
        }
        assert!(crop.f_u > all.f_u && crop.f_v > all.f_v && crop.lens == Lens::NONE);
    }

    #[test]
    fn without_a_lens_nothing_changes() {
        let camera = Camera { lens: Lens::NONE, ..camera() };
        for view in [Framing::KeepAll, Framing::CropToValid] {
            let ideal = camera.ideal(camera.size, view).unwrap();
            assert!(
                (ideal.f_u - camera.f_u).abs() <= 1e-9 && (ideal.v_0 - camera.v_0).abs() <= 1e-9,
                "{ideal:?}"
            );
        }
    }
}
