//! The README.md of a data set.

use glam::DVec3;

use super::DataSetConfig;
use super::flown::{Flown, ended};
use super::folder::Folder;
use super::truth::{Truth, grid_over};
use crate::camera::Camera;
use crate::error::Result;
use crate::io::write_bytes;
use crate::sim::Course;
use crate::text::counted;

/// Writes README.md.
pub(super) fn write(
    folder: &Folder,
    config: &DataSetConfig,
    course: &Course,
    camera: &Camera,
    flown: &Flown,
) -> Result<()> {
    let ended = flown.ended.map_or("the time was over".to_owned(), |outcome| ended(outcome).to_owned());
    let mut text = format!(
        "# A flight through {name}, seed {seed}\n\n\
         Made by viewsphere {version}{command}\n\n\
         {frames} of {size} at {fps} Hz, flown at {speed} m/s by true depth until {ended}. World, flight and gyro are \
         those of the seed; images and ground truth are rendered from the same surfaces.\n\n\
         | file | content |\n|---|---|\n\
         | frames/NNNNNN.png | images, gray, 8 bits, through the lens, with noise of {levels} gray levels |\n\
         | times.csv | each frame's time, s |\n\
         | camera.yaml | the camera in OpenCV's format: k1 k2 p1 p2 k3 k4 k5 k6, pixel centres at integer coordinates |\n\
         | poses.csv | each frame's position (north, east, down, m), attitude and velocity over ground (m/s) |\n\
         | gyro.csv | angular rate at 240 Hz about the body's axes, rad/s, with noise of {noise} rad/s/√Hz, a bias of {bias} °/s \
         at the start and its walk |\n\
         | gyro_true.csv | gyro.csv without errors |\n",
        name = course.name,
        seed = course.seed,
        version = env!("CARGO_PKG_VERSION"),
        command = config.made_by.as_ref().map_or(String::new(), |command| format!(" with\n\n    {command}")),
        frames = counted(flown.frames.len(), "frame"),
        size = camera.size,
        fps = config.rate_hz,
        speed = config.speed_m_s,
        levels = config.noise_levels,
        noise = config.gyro_errors.noise_rad_s_rthz,
        bias = biases(config.gyro_errors.bias_rad_s),
    );
    let grid = grid_over(camera, config.grid)?;
    for truth in &config.truths {
        text += &match truth {
            Truth::Flow => "| flow/NNNNNN.flo | pixels from this frame to the next one, x to the right and y down, of each \
                            pixel's centre; it may lead out of the frame; over 1e9 where the point is hidden there, or the \
                            lens shows nothing; the last frame has none |\n"
                .to_owned(),
            Truth::Depth => "| depth/NNNNNN.npy | metres along the ray of each pixel's centre, float32, height × width; \
                             infinite for the sky, NaN where the lens shows nothing |\n"
                .to_owned(),
            Truth::Nearness => {
                "| nearness/NNNNNN.npy | inverse of the depth, 1/m, float32, height × width |\n".to_owned()
            }
            Truth::Divergence => "| divergence/NNNNNN.npy | divergence of the flow on the view sphere, 1/s, float32, \
                                  height × width |\n"
                .to_owned(),
            Truth::Spherical => "| spherical/NNNNNN.npy | flow of each pixel's bearing, a vector tangent to the unit sphere \
                                 in the camera's frame, rad/s, float32, height × width × 3; the camera's rotation included |\n"
                .to_owned(),
            Truth::Grid => format!(
                "| grid/NNNNNN.npy | metres along rays at {} azimuths (columns, from {:.3}° on the left to {:.3}°) and {} \
                 elevations (rows, from {:.3}° at the top to {:.3}°), at the centres of equal parts of these ranges, float32; \
                 infinite for the sky |\n",
                grid.columns,
                grid.azimuth_rad[0].to_degrees(),
                grid.azimuth_rad[1].to_degrees(),
                grid.rows,
                grid.elevation_rad[0].to_degrees(),
                grid.elevation_rad[1].to_degrees(),
            ),
        };
    }
    if let Some(scales) = config.scales() {
        text += &format!(
            "| divergence/, nearness/NNNNNN.png | the same as an image: 0 white, above it red, below it blue, unknown gray, full \
             colour at {scales} |\n"
        );
    }
    text += "\n## Frames\n\n\
             - World: x north, y east, z down; the ground is at z = 0.\n\
             - Body: x forward, y right, z down, its origin at the camera. The quaternion w, x, y, z of poses.csv is the rotation \
             from the body's frame to the world's.\n\
             - Camera: x right, y down, z forward, along the body's y, z and x. `--camera-from-gyro frd` states that.\n\
             - Azimuth is atan2(x, z), positive to the right, elevation atan2(−y, √(x² + z²)), positive up, in the camera's \
             frame.\n\n\
             ## Use\n\n\
             \x20   viewsphere flow 'frames/%06d.png' -o estimate/\n\
             \x20   viewsphere eval --truth flow/000000.flo estimate/000000.flo\n\
             \x20   viewsphere eval --data . --run farneback,farneback-tv:fine\n\
             \x20   viewsphere run 'frames/%06d.png' --camera camera.yaml --times times.csv --gyro gyro.csv \
             --camera-from-gyro frd --heading turning\n\n\
             The sky has a true flow but no texture. `eval --data` tells it apart by its infinite depth; in `eval --truth` it \
             counts unless `--mask` excludes it.\n";
    write_bytes(folder.path("README.md"), text.as_bytes())
}

/// A bias in degrees per second, once if it is equal about all axes. The conversion's rounding is not shown.
fn biases(bias_rad_s: DVec3) -> String {
    let [x, y, z] = bias_rad_s.to_array().map(|axis| (axis.to_degrees() * 1e9).round() / 1e9);
    if [y, z] == [x, x] { x.to_string() } else { format!("{x}, {y}, {z}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn biases_are_those_that_were_asked_for() {
        for degrees in [0.0, 2.0, -0.3, 1.7, 2005.0] {
            assert_eq!(biases(DVec3::splat(f64::to_radians(degrees))), degrees.to_string());
        }
        assert_eq!(biases(DVec3::new(0.0, 1.0, 0.0)), "0, 57.295779513, 0");
    }
}
