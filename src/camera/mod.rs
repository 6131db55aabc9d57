//! Camera models: the mapping between pixels and viewing directions.
//!
//! The camera's frame is x to the right, y down, z forward. Pixel centres lie at integer coordinates (OpenCV's
//! convention). Everything here is `f64`; per-pixel work is done by kernels. Calibration files are read by
//! `io::camera`, which needs the feature `io`.

mod check;
mod framing;
mod injectivity;
mod lens;
mod pose;

use glam::{DMat3, DVec3};

pub use framing::Framing;
pub use lens::Lens;
pub(crate) use pose::is_rotation;
pub use pose::{FLU_FROM_CAMERA, FRD_FROM_CAMERA, Pose, roll_pitch_yaw_rad, world_from_body};

use crate::frame::Size;

/// A planar camera: a pinhole behind a lens, without skew.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Camera {
    /// Width and height of its images.
    pub size: Size,
    /// Focal length in pixels, along a row.
    pub f_u: f64,
    /// Focal length in pixels, along a column.
    pub f_v: f64,
    /// Column of the principal point.
    pub u_0: f64,
    /// Row of the principal point.
    pub v_0: f64,
    /// The distortion of the lens.
    pub lens: Lens,
}

impl Camera {
    /// The direction of the ray through a pixel, given as `[column, row]`: a unit vector in the camera's frame.
    /// `None` where the lens map is not invertible.
    pub fn ray(&self, pixel: [f64; 2]) -> Option<DVec3> {
        let distorted = [(pixel[0] - self.u_0) / self.f_u, (pixel[1] - self.v_0) / self.f_v];
        let [x, y] = self.lens.undistort(distorted)?;
        let ray = DVec3::new(x, y, 1.0).normalize();
        ray.is_finite().then_some(ray)
    }

    /// The pixel `[column, row]` that shows a point, which may lie outside the image. `None` for a point that is not
    /// in front of the camera, and where the lens has no image of it or would map two directions to one pixel.
    pub fn project(&self, point_camera: DVec3) -> Option<[f64; 2]> {
        let DVec3 { x, y, z } = point_camera;
        if !(z > 0.0 && z.is_finite()) {
            return None;
        }
        let ideal = [x / z, y / z];
        if !self.lens.is_one_to_one_to(ideal[0].hypot(ideal[1])) {
            return None;
        }
        let [x, y] = self.lens.distort(ideal);
        let pixel = [self.f_u * x + self.u_0, self.f_v * y + self.v_0];
        pixel.iter().all(|c| c.is_finite()).then_some(pixel)
    }

    /// The pixel at which this camera shows what another camera at the same place, with another rotation, shows at
    /// `pixel`: the map of the kernel [`crate::kernels::undistort_map`], in `f64`.
    pub fn place_of(&self, other: &Self, this_from_other: &DMat3, pixel: [f64; 2]) -> Option<[f64; 2]> {
        self.project(*this_from_other * other.ray(pixel)?)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn camera(coefficients: &[f64]) -> Camera {
        let lens = Lens::new(coefficients).unwrap();
        Camera { size: Size::new(640, 480), f_u: 400.0, f_v: 410.0, u_0: 322.5, v_0: 236.0, lens }
    }

    #[test]
    fn the_frame_is_right_down_forward() {
        let camera = camera(&[]);
        assert_eq!(camera.ray([322.5, 236.0]), Some(DVec3::Z));
        assert_eq!(camera.project(DVec3::new(1.0, 0.0, 2.0)), Some([522.5, 236.0]));
        assert_eq!(camera.project(DVec3::new(0.0, 1.0, 2.0)), Some([322.5, 441.0]));
    }

    #[test]
    fn what_is_not_in_front_has_no_pixel() {
        let camera = camera(&[-0.3, 0.1, 1e-3, -1e-3]);
        for point in [[0.0, 0.0, -1.0], [1.0, 1.0, 0.0], [0.0, 0.0, f64::NAN], [f64::NAN, 0.0, 1.0]] {
            assert_eq!(camera.project(point.into()), None, "{point:?}");
        }
        assert_eq!(camera.project(DVec3::new(1e200, 0.0, 1e-200)), None);
        assert_eq!(camera.ray([f64::NAN, 0.0]), None);
        assert_eq!(camera.ray([f64::INFINITY, 0.0]), None);
    }

    /// With a mild lens, a strong rational one and pincushion, projecting each pixel's ray gives the pixel again.
    #[test]
    fn every_pixel_comes_back_from_its_ray() {
        let wide = [0.25, 0.01, -3e-4, 8e-5, 0.002, 0.6, 0.08, 0.006];
        for coefficients in [&[-0.28, 0.07, 2e-4, 2e-5][..], &wide, &[0.1, 0.02, 1e-3, -1e-3, 0.01], &[]] {
            let camera = camera(coefficients);
            for v in 0..480 {
                for u in 0..640 {
                    let pixel = [f64::from(u), f64::from(v)];
                    let back = camera.project(camera.ray(pixel).unwrap()).unwrap();
                    let error = (back[0] - pixel[0]).hypot(back[1] - pixel[1]);
                    assert!(error <= 1e-9, "{coefficients:?} {pixel:?} {back:?}");
                }
            }
        }
    }
}
