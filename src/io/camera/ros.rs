//! ROS's camera_info YAML: calibration files, and messages as `rostopic echo` and `ros2 topic echo` print them.

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
    let size = yaml.size(&[yaml.name(&["image_width", "width"]), yaml.name(&["image_height", "height"])])?;
    let matrix = yaml.array::<9>(yaml.name(&["camera_matrix/data", "k"]))?;
    let key = yaml.name(&["distortion_coefficients/data", "d"]);
    let coefficients = yaml.numbers(key)?;
    let model = yaml.word("distortion_model");
    let counts: &[usize] = match model {
        "plumb_bob" => &[0, 4, 5],
        "rational_polynomial" => &[8],
        "" | "none" => &[0],
        _ => {
            return Err(Error::format(
                yaml.path,
                "distortion_model",
                model,
                "plumb_bob or rational_polynomial",
            ));
        }
    };
    if !counts.contains(&coefficients.len()) {
        let counts = counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" or ");
        let expected = format!("{counts} of the distortion_model {model:?}");
        return Err(Error::format(yaml.path, key, format_args!("{} numbers", coefficients.len()), expected));
    }
    from_matrix(yaml.path, size, matrix, lens(yaml.path, key, &coefficients)?)
}

/// Encodes a file.
pub fn encode(camera: &Camera) -> Vec<u8> {
    let Camera { size, f_u, f_v, u_0, v_0, lens } = *camera;
    let coefficients = lens.shortest();
    let model = if coefficients.len() == 8 { "rational_polynomial" } else { "plumb_bob" };
    let matrix = |name: &str, rows: usize, cols: usize, values: &[f64]| {
        let list = values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ");
        format!("{name}:\n  rows: {rows}\n  cols: {cols}\n  data: [{list}]\n")
    };
    [
        format!("image_width: {}\nimage_height: {}\ncamera_name: camera\n", size.width, size.height),
        matrix("camera_matrix", 3, 3, &[f_u, 0.0, u_0, 0.0, f_v, v_0, 0.0, 0.0, 1.0]),
        format!("distortion_model: {model}\n"),
        matrix("distortion_coefficients", 1, coefficients.len(), coefficients),
        matrix("rectification_matrix", 3, 3, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
        matrix("projection_matrix", 3, 4, &[f_u, 0.0, u_0, 0.0, 0.0, f_v, v_0, 0.0, 0.0, 0.0, 1.0, 0.0]),
    ]
    .concat()
    .into_bytes()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::camera::Lens;
    use crate::frame::Size;

    /// A file as camera_calibration writes it.
    const FILE: &str = "image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.78337, 0.     , 305.59334,
         0.     , 437.30288, 243.73835,
         0.     , 0.     , 1.     ]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.361976, 0.110510, 0.001014, 0.000505, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1., 0., 0.,
         0., 1., 0.,
         0., 0., 1.]
projection_matrix:
  rows: 3
  cols: 4
  data: [393.65384,   0.     , 322.79794,   0.     ,
           0.     , 397.13934, 241.09018,   0.     ,
           0.     ,   0.     ,   1.     ,   0.     ]
";

    /// A message as `rostopic echo` prints it.
    const MESSAGE: &str = "header: 
  seq: 12
  stamp: 
    secs: 1700000000
    nsecs: 5
  frame_id: \"camera_optical\"
height: 480
width: 640
distortion_model: \"plumb_bob\"
D: [-0.361976, 0.11051, 0.001014, 0.000505, 0.0]
K: [438.78337, 0.0, 305.59334, 0.0, 437.30288, 243.73835, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [393.65384, 0.0, 322.79794, 0.0, 0.0, 397.13934, 241.09018, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
roi: 
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: False
---
header: 
  seq: 13
";

    fn camera() -> Camera {
        let lens = Lens::new(&[-0.361976, 0.11051, 0.001014, 0.000505, 0.0]).unwrap();
        let size = Size::new(640, 480);
        Camera { size, f_u: 438.78337, f_v: 437.30288, u_0: 305.59334, v_0: 243.73835, lens }
    }

    fn load(text: &str) -> Result<Camera> {
        decode(Path::new("a.yaml"), text.as_bytes())
    }

    #[test]
    fn files_and_messages_are_read() {
        assert_eq!(load(FILE).unwrap(), camera());
        assert_eq!(load(MESSAGE).unwrap(), camera());
        // ros2 topic echo: lower-case keys, and one line per number.
        let lines = |list: &str| list.split(", ").map(|n| format!("- {n}\n")).collect::<String>();
        let ros2 = format!(
            "height: 480\nwidth: 640\ndistortion_model: plumb_bob\nd:\n{}k:\n{}---\n",
            lines("-0.361976, 0.11051, 0.001014, 0.000505, 0.0"),
            lines("438.78337, 0.0, 305.59334, 0.0, 437.30288, 243.73835, 0.0, 0.0, 1.0"),
        );
        assert_eq!(load(&ros2).unwrap(), camera());
    }

    #[test]
    fn the_model_and_the_number_of_coefficients_belong_together() {
        let error = |from: &str, to: &str| {
            assert!(FILE.contains(from));
            load(&FILE.replace(from, to)).unwrap_err().to_string()
        };
        assert_eq!(
            error("0.000505, 0.000000]", "0.000505, 0, 0, 0, 0]"),
            "a.yaml: distortion_coefficients/data is 8 numbers, expected 0 or 4 or 5 of the distortion_model \"plumb_bob\""
        );
        assert_eq!(
            error("plumb_bob", "rational_polynomial"),
            "a.yaml: distortion_coefficients/data is 5 numbers, expected 8 of the distortion_model \
             \"rational_polynomial\""
        );
        assert_eq!(
            error("plumb_bob", "equidistant"),
            "a.yaml: distortion_model is equidistant, expected plumb_bob or rational_polynomial"
        );
    }
}
