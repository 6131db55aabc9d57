//! Kalibr's camchain YAML: several cameras, each a pinhole with the `radtan` model of four coefficients.

use std::path::Path;

use super::yaml::Yaml;
use super::{from_intrinsics, lens, number, text};
use crate::camera::Camera;
use crate::error::{Error, Result};

/// Decodes the camera `cam0` of a file. See [`decode_named`].
///
/// # Errors
/// As in [`decode_named`].
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Camera> {
    decode_named(path, bytes, "cam0")
}

/// Decodes the camera of this name from the bytes of a file. `path` is the name for error messages. The camera is not
/// yet validated: see [`Camera::validate`].
///
/// # Errors
/// [`Error::Format`] if there is no such camera, or naming the key that is missing or wrong.
pub fn decode_named(path: &Path, bytes: &[u8], name: &str) -> Result<Camera> {
    from_yaml(&Yaml::parse(path, text(path, bytes)?)?, name)
}

pub(super) fn from_yaml(chain: &Yaml<'_>, name: &str) -> Result<Camera> {
    let yaml = chain.within(name);
    if yaml.keys().is_empty() {
        let cameras: Vec<&str> = chain.keys().into_iter().filter(|key| key.starts_with("cam")).collect();
        let expected = format!("one of {}", cameras.join(", "));
        return Err(Error::format(chain.path, "camera", format_args!("{name}, which is missing"), expected));
    }
    from_sensor(&yaml, "distortion_coeffs", "radtan")
}

/// Reads the keys that Kalibr and EuRoC share.
pub(super) fn from_sensor(yaml: &Yaml<'_>, coefficients: &'static str, radtan: &str) -> Result<Camera> {
    let model = yaml.word("camera_model");
    if model != "pinhole" {
        return Err(Error::format(yaml.path, "camera_model", format!("{model:?}"), "pinhole"));
    }
    let size = yaml.size(&["resolution"])?;
    let intrinsics = yaml.array::<4>("intrinsics")?;
    let model = yaml.word("distortion_model");
    let coefficients = match model {
        "none" => Vec::new(),
        model if model == radtan => yaml.array::<4>(coefficients)?.to_vec(),
        _ => return Err(Error::format(yaml.path, "distortion_model", format!("{model:?}"), radtan)),
    };
    Ok(from_intrinsics(size, intrinsics, lens(yaml.path, "distortion_coeffs", &coefficients)?))
}

/// Encodes a file with this camera as `cam0`.
///
/// # Errors
/// [`Error::Parameter`] if the lens has more than the four coefficients that the format can hold.
pub fn encode(camera: &Camera) -> Result<Vec<u8>> {
    let Camera { size, f_u, f_v, u_0, v_0, lens } = *camera;
    if lens.coefficients[4..].iter().any(|c| *c != 0.0) {
        let found = format!("{:?}", &lens.coefficients[4..]);
        return Err(Error::parameter("k3 k4 k5 k6", found, "0, as a camchain holds k1 k2 p1 p2 only"));
    }
    let list = |values: &[f64]| values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ");
    let text = format!(
        "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [{}]\n  distortion_model: radtan\n  intrinsics: [{}]\n  \
         resolution: [{}, {}]\n  rostopic: /cam0/image_raw\n",
        list(&lens.coefficients[..4]),
        list(&[f_u, f_v, u_0, v_0]),
        size.width,
        size.height,
    );
    Ok(text.into_bytes())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::camera::Lens;
    use crate::frame::Size;

    /// A file as kalibr_calibrate_imu_camera writes it.
    const FILE: &str = "cam0:
  T_cam_imu:
  - [0.01779318, 0.99967549, -0.01822936, 0.07008565]
  - [-0.9998017, 0.01795239, 0.00860714, -0.01771023]
  - [0.00893160, 0.01807260, 0.99979678, 0.00399246]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.2794, 0.0712, -0.0001, 2.5e-05]
  distortion_model: radtan
  intrinsics: [461.629, 460.152, 362.680, 246.049]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: -8.121e-05
cam1:
  T_cn_cnm1:
  - [0.99999, -0.0023, -0.0003, -0.11007]
  - [0.0023, 0.99989, 0.0141, 0.00039]
  - [0.0003, -0.0141, 0.9999, -0.00085]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0003, -9.0e-06]
  distortion_model: radtan
  intrinsics: [459.357, 457.876, 379.048, 255.387]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
";

    fn load(text: &str, name: &str) -> Result<Camera> {
        decode_named(Path::new("a.yaml"), text.as_bytes(), name)
    }

    #[test]
    fn each_camera_of_a_chain_is_read() {
        let lens = Lens::new(&[-0.2794, 0.0712, -0.0001, 2.5e-05]).unwrap();
        let size = Size::new(752, 480);
        let camera = Camera { size, f_u: 461.629, f_v: 460.152, u_0: 362.68, v_0: 246.049, lens };
        assert_eq!(load(FILE, "cam0").unwrap(), camera);
        assert_eq!(load(FILE, "cam1").unwrap().f_u, 459.357);
        assert_eq!(
            load(FILE, "cam2").unwrap_err().to_string(),
            "a.yaml: camera is cam2, which is missing, expected one of cam0, cam1"
        );
    }

    #[test]
    fn other_models_are_refused() {
        let error = |from: &str, to: &str| load(&FILE.replace(from, to), "cam0").unwrap_err().to_string();
        assert_eq!(error("pinhole", "omni"), "a.yaml: camera_model is \"omni\", expected pinhole");
        assert_eq!(
            error("radtan", "equidistant"),
            "a.yaml: distortion_model is \"equidistant\", expected radtan"
        );
        assert_eq!(
            error("-0.0001, 2.5e-05", "-0.0001"),
            "a.yaml: distortion_coeffs is [-0.2794, 0.0712, -0.0001], expected 4 numbers"
        );
    }

    #[test]
    fn a_lens_of_more_coefficients_is_not_written() {
        let mut camera = load(FILE, "cam0").unwrap();
        camera.lens.coefficients[4] = 0.1;
        assert!(encode(&camera).unwrap_err().to_string().starts_with("k3 k4 k5 k6 is [0.1, 0.0, 0.0, 0.0]"));
    }
}
