//! Validation of cameras from files: an error names what is wrong before images are processed with it.

use super::Camera;
use crate::error::{Error, Result};
use crate::frame::Size;

/// The largest tangential coefficient of a plausible lens: at the corner of a wide image (r = 1) it moves a point by
/// 15 % of its distance. Larger values come from files that list k3 before p1 and p2.
const MAX_TANGENTIAL: f64 = 0.05;

impl Camera {
    /// Checks that the parameters are plausible, and that the lens map is invertible in the whole image.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming what is wrong: the size, an implausible focal length or principal point, lens
    /// coefficients in another order, a root of the denominator or a fold of the map inside the image.
    pub fn validate(&self) -> Result<()> {
        self.size.validate()?;
        for (name, value) in [("f_u", self.f_u), ("f_v", self.f_v)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::parameter(name, value, "a focal length over 0 px"));
            }
        }
        for (name, value, side) in [("u_0", self.u_0, self.size.width), ("v_0", self.v_0, self.size.height)] {
            let side = f64::from(side);
            // The axis may well lie outside a part cropped from a larger image.
            if !(value.abs() <= 10.0 * side) {
                return Err(Error::parameter(
                    name,
                    value,
                    format_args!("a position near the image, of {side} px"),
                ));
            }
        }
        self.validate_coefficients()?;
        self.validate_lens()
    }

    fn validate_coefficients(&self) -> Result<()> {
        const NAMES: [&str; 8] = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
        for (name, value) in NAMES.into_iter().zip(self.lens.coefficients) {
            if !value.is_finite() {
                return Err(Error::parameter(name, value, "a finite number"));
            }
        }
        for (i, name) in [(2, "p1"), (3, "p2")] {
            let value = self.lens.coefficients[i];
            if !(value.abs() <= MAX_TANGENTIAL) {
                let expected = format!("within ±{MAX_TANGENTIAL}: is the order not k1 k2 p1 p2 k3 k4 k5 k6?");
                return Err(Error::parameter(name, value, expected));
            }
        }
        Ok(())
    }

    fn validate_lens(&self) -> Result<()> {
        let root = self.lens.denominator_root();
        let angle = |radius: f64| format!("{:.1}°", radius.atan().to_degrees());
        let root_inside = |root: f64, [u, v]: [f64; 2]| {
            let found = format!("0 at {} from the axis, before pixel {u}, {v}", angle(root));
            let expected = "a lens whose k4 k5 k6 give no root inside the image";
            Err(Error::parameter("the lens's denominator", found, expected))
        };
        for pixel in self.border() {
            // Before the root the formula may rise without bound without folding.
            let pinhole = ((pixel[0] - self.u_0) / self.f_u).hypot((pixel[1] - self.v_0) / self.f_v);
            if let Some(root) = root.filter(|root| !(pinhole < *root)) {
                return root_inside(root, pixel);
            }
            if self.ideal_place(pixel).is_some() {
                continue;
            }
            let limit = self.lens.radius_limit();
            if let Some(root) = root.filter(|root| *root <= 1.1 * limit) {
                return root_inside(root, pixel);
            }
            let found = format!(
                "folding back at {} from the axis, before pixel {}, {}",
                angle(limit),
                pixel[0],
                pixel[1]
            );
            return Err(Error::parameter(
                "the lens's map",
                found,
                "one that rises to the corners of the image",
            ));
        }
        Ok(())
    }

    /// The border's pixels, corners first: where the map is invertible on the border, it is so inside.
    fn border(&self) -> impl Iterator<Item = [f64; 2]> {
        let Size { width, height } = self.size;
        let [right, bottom] = [width - 1, height - 1].map(f64::from);
        let corners = [[0.0, 0.0], [right, 0.0], [0.0, bottom], [right, bottom]];
        let rows = (0..width).map(f64::from).flat_map(move |u| [[u, 0.0], [u, bottom]]);
        let columns = (0..height).map(f64::from).flat_map(move |v| [[0.0, v], [right, v]]);
        corners.into_iter().chain(rows).chain(columns)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::Lens;
    use super::*;

    fn camera(coefficients: &[f64]) -> Camera {
        let lens = Lens::new(coefficients).unwrap();
        Camera { size: Size::new(1280, 960), f_u: 567.0, f_v: 568.0, u_0: 650.0, v_0: 500.0, lens }
    }

    #[track_caller]
    fn refused(camera: &Camera, words: &[&str]) {
        let text = camera.validate().unwrap_err().to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}: {words:?}");
    }

    #[test]
    fn usual_cameras_pass() {
        for coefficients in [
            &[][..],
            &[-0.28, 0.07, 2e-4, 2e-5],
            &[0.25, 0.01, -3e-4, 8e-5, 0.002, 0.6, 0.08, 0.006],
            &[0.1, 0.02, 1e-3, -1e-3, 0.01],
        ] {
            let camera = camera(coefficients);
            let narrow = Camera { f_u: 1200.0, f_v: 1200.0, ..camera };
            narrow.validate().unwrap();
        }
        camera(&[]).validate().unwrap();
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let camera = camera(&[]);
        refused(&Camera { f_u: 0.0, ..camera }, &["f_u is 0"]);
        refused(&Camera { f_v: f64::NAN, ..camera }, &["f_v is NaN"]);
        refused(&Camera { u_0: 1e9, ..camera }, &["u_0 is 1000000000"]);
        refused(&Camera { size: Size::new(0, 1), ..camera }, &["size is 0×1"]);
        let lens = Lens { coefficients: [0.0, f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
        refused(&Camera { lens, ..camera }, &["k2 is inf"]);
    }

    #[test]
    fn another_order_of_the_coefficients_is_noticed() {
        // k1 k2 k3 p1 p2, of the calibration that comes with OpenCV's samples.
        refused(&camera(&[-0.266, -0.0386, 0.2384, 1.78e-3, -2.8e-4]), &["p1 is 0.2384", "k1 k2 p1 p2 k3"]);
    }

    #[test]
    fn a_fold_inside_the_picture_is_named() {
        refused(&camera(&[-0.28, 0.02, 2e-4, 2e-5]), &["map is folding back at", "pixel 0, 0"]);
    }

    /// OpenCV's rational calibration of a wide GoPro: root and zero nearly cancel, 58° from the axis.
    #[test]
    fn a_root_of_the_denominator_inside_the_picture_is_named() {
        let calibrated =
            [-0.061748, -0.124086, -0.000335, 7.6386e-5, -0.001308, 0.205595, -0.19424975, -0.0145098];
        refused(&camera(&calibrated), &["denominator is 0 at 58.0°", "pixel 0, 0"]);
    }
}
