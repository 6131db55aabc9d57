use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::error::{Error, Result};

/// A frame rate: a number of frames in a number of seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRate {
    frames: f64,
    seconds: f64,
}

impl FrameRate {
    /// 30 frames per second, which is assumed where a source states none.
    pub const DEFAULT: Self = Self { frames: 30.0, seconds: 1.0 };

    /// The rate of a video's header, as `io::Frames::rate` returns it: frames and seconds, both over 0.
    pub fn of_fraction((frames, seconds): (u32, u32)) -> Self {
        Self { frames: f64::from(frames), seconds: f64::from(seconds) }
    }

    /// Frames and seconds for a video's header; rounded to a thousandth of a frame per second if the rate is not such a
    /// fraction.
    pub fn fraction(self) -> (u32, u32) {
        let whole = |value: f64| value.fract() == 0.0 && value <= f64::from(u32::MAX);
        if whole(self.frames) && whole(self.seconds) {
            return (self.frames as u32, self.seconds as u32);
        }
        ((1000.0 * self.frames / self.seconds).round().max(1.0) as u32, 1000)
    }
}

/// Reads `25`, `29.97` and `30000/1001`: 0.001 to 1000000 frames per second.
impl FromStr for FrameRate {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::parameter("frame rate", text, "0.001 to 1000000, such as 25 or 30000/1001");
        let (frames, seconds) = text.split_once(['/', ':']).unwrap_or((text, "1"));
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
        let rate = Self { frames: number(frames)?, seconds: number(seconds)? };
        let sound = rate.frames > 0.0 && rate.seconds > 0.0;
        let sound = sound && (0.001..=1e6).contains(&(rate.frames / rate.seconds));
        if sound { Ok(rate) } else { Err(wrong()) }
    }
}

/// The frames' times: a constant rate, or a list.
#[derive(Clone, Debug)]
pub struct FrameTimes {
    rate: FrameRate,
    listed: Option<(PathBuf, Vec<f64>)>,
    start_s: f64,
}

impl FrameTimes {
    /// Times at a constant rate, from `start_s` on.
    pub fn even(rate: FrameRate, start_s: f64) -> Self {
        Self { rate, listed: None, start_s }
    }

    /// Times from a list in seconds, such as that of `io::frame_times::read`; `start_s` is added to each. `path` is the
    /// list's name for error messages.
    ///
    /// # Errors
    /// [`Error::Format`] for an empty list, or one whose length is not the number of `frames`, if that is known.
    pub fn listed(
        path: impl AsRef<Path>,
        times_s: Vec<f64>,
        frames: Option<u64>,
        start_s: f64,
    ) -> Result<Self> {
        let (path, count) = (path.as_ref().to_owned(), times_s.len());
        let (Some(first), Some(last)) = (times_s.first(), times_s.last()) else {
            return Err(miscounted(&path, 0, "at least 1"));
        };
        if let Some(frames) = frames.filter(|frames| *frames != count as u64) {
            return Err(miscounted(&path, count, format_args!("{frames}, one for each frame")));
        }
        let per_second = (count - 1) as f64 / (last - first);
        let frames = if (0.001..=1e6).contains(&per_second) { per_second } else { FrameRate::DEFAULT.frames };
        Ok(Self { rate: FrameRate { frames, seconds: 1.0 }, listed: Some((path, times_s)), start_s })
    }

    /// The rate, or the mean rate of a list.
    pub fn rate(&self) -> FrameRate {
        self.rate
    }

    /// The time of a frame in seconds.
    ///
    /// # Errors
    /// [`Error::Format`] if a list has no time for it.
    pub fn of(&self, number: u64) -> Result<f64> {
        let time_s = match &self.listed {
            None => number as f64 * self.rate.seconds / self.rate.frames,
            Some((path, times)) => {
                *usize::try_from(number).ok().and_then(|number| times.get(number)).ok_or_else(|| {
                    miscounted(path, times.len(), "one for each frame, of which there are more")
                })?
            }
        };
        Ok(self.start_s + time_s)
    }

    /// Checks that a list has no more times than this number of frames.
    ///
    /// # Errors
    /// [`Error::Format`] if it has.
    pub fn check_end(&self, frames: u64) -> Result<()> {
        match &self.listed {
            Some((path, times)) if times.len() as u64 != frames => {
                Err(miscounted(path, times.len(), format_args!("{frames}, one for each frame")))
            }
            _ => Ok(()),
        }
    }
}

fn miscounted(path: &Path, found: usize, expected: impl ToString) -> Error {
    Error::format(path, "number of frame times", found, expected)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_a_number_or_a_fraction() {
        for (text, fraction) in [("25", (25, 1)), ("30000/1001", (30000, 1001))] {
            assert_eq!(text.parse::<FrameRate>().unwrap(), FrameRate::of_fraction(fraction));
            assert_eq!(FrameRate::of_fraction(fraction).fraction(), fraction);
        }
        assert_eq!("29.97".parse::<FrameRate>().unwrap().fraction(), (29970, 1000));
        for text in ["0", "-1", "NaN", "inf", "x", "1/0", "2e6", ""] {
            assert!(text.parse::<FrameRate>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_list_has_a_time_for_each_frame_and_the_mean_rate() {
        let listed = |times_s: &[f64], frames| FrameTimes::listed("t.csv", times_s.to_vec(), frames, 10.0);
        let times = listed(&[0.0, 0.25, 1.0], Some(3)).unwrap();
        assert_eq!((times.of(1).unwrap(), times.rate().fraction()), (10.25, (2, 1)));
        times.check_end(3).unwrap();
        for error in [
            times.of(3).unwrap_err(),
            times.check_end(2).unwrap_err(),
            listed(&[0.0], Some(2)).unwrap_err(),
            listed(&[], None).unwrap_err(),
        ] {
            assert!(error.to_string().starts_with("t.csv: number of frame times is "), "{error}");
        }
        // A list without a span has no rate of its own.
        assert_eq!(listed(&[0.5], None).unwrap().rate(), FrameRate::DEFAULT);
    }
}
