//! OpenCV's FileStorage YAML, as its calibration programs write it.

use std::path::Path;

use super::yaml::Yaml;
use super::{from_matrix, lens, number, text};
use crate::camera::Camera;
use crate::error::{Error, Result};

/// Decodes a camera from the bytes of a file. `path` is the name for error messages. The camera is not yet validated:
/// see [`Camera::validate`].
///
/// # Errors
/// [`Error::Format`] naming the key that is missing or wrong.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Camera> {
    from_yaml(&Yaml::parse(path, text(path, bytes)?)?)
}

pub(super) fn from_yaml(yaml: &Yaml<'_>) -> Result<Camera> {
    let size = yaml.size(&["image_width", "image_height"])?;
    if !["", "0"].contains(&yaml.word("fisheye_model")) {
        let expected = "0: a planar camera with the coefficients k1 k2 p1 p2 k3 k4 k5 k6";
        return Err(Error::format(yaml.path, "fisheye_model", yaml.word("fisheye_model"), expected));
    }
    let matrix = yaml.array::<9>("camera_matrix/data")?;
    let key = yaml.name(&["distortion_coefficients/data", "distortion_coefficients"]);
    let mut coefficients = yaml.numbers(key)?;
    // The longer lists add thin prisms and a tilted sensor, which are mostly written without being calibrated.
    if [12, 14].contains(&coefficients.len()) && coefficients[8..].iter().all(|c| *c == 0.0) {
        coefficients.truncate(8);
    }
    from_matrix(yaml.path, size, matrix, lens(yaml.path, key, &coefficients)?)
}

/// Encodes a file.
pub fn encode(camera: &Camera) -> Vec<u8> {
    let Camera { size, f_u, f_v, u_0, v_0, lens } = *camera;
    let matrix = [f_u, 0.0, u_0, 0.0, f_v, v_0, 0.0, 0.0, 1.0];
    let coefficients = lens.shortest();
    let list = |values: &[f64]| values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ");
    format!(
        "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n\
         camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n\
         distortion_coefficients: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   data: [ {} ]\n",
        size.width,
        size.height,
        list(&matrix),
        coefficients.len(),
        list(coefficients),
    )
    .into_bytes()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::camera::Lens;
    use crate::frame::Size;

    /// A file as OpenCV 4's camera_calibration sample writes it.
    const FILE: &str = "%YAML:1.0
---
calibration_time: \"Tue Nov  3 10:11:12 2026\"
nr_of_frames: 13
image_width: 640
image_height: 480
board_width: 9
board_height: 6
square_size: 2.5000000372529030e-02
aspectRatio: 1.
# flags:  +fix_aspectRatio +fix_principal_point +zero_tangent_dist
flags: 14
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3591573396163199e+02, 0., 3.4228315473308373e+02, 0.,
       5.3591573396163199e+02, 2.3557082909788173e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.6637260909660682e-01, -3.8588898922304653e-02,
       1.7831947042852964e-03, -2.8122100441115472e-04,
       2.3839153080878486e-01 ]
avg_reprojection_error: 3.9259098975581364e-01
per_view_reprojection_errors: !!opencv-matrix
   rows: 2
   cols: 1
   dt: f
   data: [ 1.92965463e-01, 1.18204820e+00 ]
";

    #[allow(clippy::excessive_precision, reason = "as they stand in the file")]
    fn camera() -> Camera {
        let lens = [
            -2.6637260909660682e-01,
            -3.8588898922304653e-02,
            1.7831947042852964e-03,
            -2.8122100441115472e-04,
            2.3839153080878486e-01,
        ];
        Camera {
            size: Size::new(640, 480),
            f_u: 5.3591573396163199e+02,
            f_v: 5.3591573396163199e+02,
            u_0: 3.4228315473308373e+02,
            v_0: 2.3557082909788173e+02,
            lens: Lens::new(&lens).unwrap(),
        }
    }

    fn load(text: &str) -> Result<Camera> {
        decode(Path::new("a.yml"), text.as_bytes())
    }

    #[track_caller]
    fn refused(from: &str, to: &str, expected: &str) {
        assert!(FILE.contains(from));
        assert_eq!(load(&FILE.replace(from, to)).unwrap_err().to_string(), expected);
    }

    #[test]
    fn a_file_of_opencv_is_read() {
        assert_eq!(load(FILE).unwrap(), camera());
        let old = FILE.replace("camera_matrix", "Camera_Matrix").replace("image_width", "image_Width");
        assert_eq!(load(&old).unwrap(), camera());
    }

    #[test]
    fn what_is_wrong_is_named() {
        refused("image_width: 640", "", "a.yml: image_width is missing, expected a list of numbers");
        refused(
            "image_width: 640",
            "image_width: 6.5",
            "a.yml: size is 6.5×480, expected 1×1 to 16384×16384",
        );
        refused(
            "fisheye_model: 0",
            "fisheye_model: 1",
            "a.yml: fisheye_model is 1, expected 0: a planar camera with the coefficients k1 k2 p1 p2 k3 k4 k5 k6",
        );
        refused("+02, 0., 3.42", "+02, 0.1, 3.42", "a.yml: skew of the camera matrix is 0.1, expected 0");
        refused(
            "2.3839153080878486e-01",
            "0, 0",
            "a.yml: distortion_coefficients/data is 6 numbers, expected 0, 4, 5 or 8, in the order k1 k2 p1 p2 k3 k4 k5 k6",
        );
    }
}
