use super::Truth;
use crate::error::{Error, Result};
use crate::frame::{Image, Plane, Size};
use crate::sim::RendererConfig;
use crate::sim::vehicle::GyroErrors;

/// Steps of the vehicle, and samples of its gyro, per second.
pub const STEPS_PER_S: u32 = 240;

/// Paints a plane as an image; the second argument is the value shown in full colour. One is `report::diverging`.
pub type Paint = fn(&Plane, f64) -> Result<Image>;

/// Configuration of a data set.
#[derive(Clone, Debug)]
pub struct DataSetConfig {
    /// Seed of the noise of the images and of the gyro. A course has its own.
    pub seed: u64,
    /// Number of frames, at least 2. There are fewer if the flight ends earlier.
    pub frames: usize,
    /// Frames per second: a divisor of [`STEPS_PER_S`].
    pub rate_hz: u32,
    /// Airspeed, m/s, at which the airframe can hold its altitude: 7.7 to 25.
    pub speed_m_s: f64,
    /// Standard deviation of the image noise in gray levels, 0 to 64.
    pub noise_levels: f64,
    /// Errors of the gyro in `gyro.csv`.
    pub gyro_errors: GyroErrors,
    /// The kinds of ground truth to write, each as one file per frame.
    pub truths: Vec<Truth>,
    /// Number of azimuths and elevations of [`Truth::Grid`].
    pub grid: Size,
    /// Paints an image beside each file of the truths that have a [`Truth::full_colour`], if given.
    pub paint: Option<Paint>,
    /// The command that creates the same data set, for its README.md.
    pub made_by: Option<String>,
}

impl Default for DataSetConfig {
    /// 20 s at 30 Hz and 12 m/s, with flow and depth.
    fn default() -> Self {
        Self {
            seed: 0,
            frames: 600,
            rate_hz: 30,
            speed_m_s: 12.0,
            noise_levels: 2.0,
            gyro_errors: GyroErrors::default(),
            truths: vec![Truth::Flow, Truth::Depth],
            grid: Size::new(32, 24),
            paint: None,
            made_by: None,
        }
    }
}

impl DataSetConfig {
    /// Checks every field but the speed, whose range depends on the airframe.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first that is out of range.
    pub fn validate(&self) -> Result<()> {
        if self.frames < 2 {
            return Err(Error::parameter("frames", self.frames, "at least 2"));
        }
        if self.rate_hz == 0 || !STEPS_PER_S.is_multiple_of(self.rate_hz) {
            return Err(Error::parameter(
                "rate_hz",
                self.rate_hz,
                format_args!("a divisor of {STEPS_PER_S}"),
            ));
        }
        RendererConfig { noise_levels: self.noise_levels, ..RendererConfig::default() }.validate()?;
        self.gyro_errors.validate()?;
        if self.paint.is_some() && self.scales().is_none() {
            return Err(Error::parameter("paint", "given", "divergence or nearness in truths"));
        }
        self.grid.validate().map(|_| ())
    }

    /// The values that images of ground truth show in full colour, as text; `None` without such images.
    pub fn scales(&self) -> Option<String> {
        let scale = |truth: &Truth| {
            let unit = if *truth == Truth::Divergence { "/s" } else { "/m" };
            let full = truth.full_colour(self.speed_m_s).filter(|_| self.paint.is_some())?;
            Some(format!("{} ±{full:.4} {unit}", truth.name()))
        };
        let scales: Vec<String> = self.truths.iter().filter_map(scale).collect();
        (!scales.is_empty()).then(|| scales.join(", "))
    }

    /// The uncompressed size of a frame in bytes: its image and its ground truth.
    pub fn bytes_per_frame(&self, picture: Size) -> f64 {
        let truths = self.truths.iter().map(|truth| truth.bytes(picture, self.grid));
        picture.pixels() as f64 + truths.sum::<f64>()
    }

    pub(super) fn steps_per_frame(&self) -> usize {
        (STEPS_PER_S / self.rate_hz) as usize
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_legal_and_each_field_is_checked() {
        let good = DataSetConfig::default;
        good().validate().unwrap();
        let noisy = GyroErrors { noise_rad_s_rthz: -1.0, ..GyroErrors::default() };
        for (name, wrong) in [
            ("frames", DataSetConfig { frames: 1, ..good() }),
            ("rate_hz", DataSetConfig { rate_hz: 0, ..good() }),
            ("rate_hz", DataSetConfig { rate_hz: 7, ..good() }),
            ("noise_levels", DataSetConfig { noise_levels: f64::NAN, ..good() }),
            ("noise_rad_s_rthz", DataSetConfig { gyro_errors: noisy, ..good() }),
            ("paint", DataSetConfig { paint: Some(|_, _| Ok(Image::default())), ..good() }),
            ("size", DataSetConfig { grid: Size::new(0, 4), ..good() }),
        ] {
            let text = wrong.validate().unwrap_err().to_string();
            assert!(text.starts_with(&format!("{name} is ")), "{text}");
        }
    }
}
