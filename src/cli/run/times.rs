//! When each frame was taken.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::error::{Error, Result};

/// A list is read no further than this, so that a file of another kind is not read whole.
const MAX_BYTES: u64 = 1 << 28;

/// Frames in so many seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rate {
    frames: f64,
    seconds: f64,
}

impl Rate {
    /// What pictures and raw frames are taken to have.
    pub(super) const DEFAULT: Self = Self { frames: 30.0, seconds: 1.0 };

    pub(super) fn of_fraction((frames, seconds): (u32, u32)) -> Self {
        Self { frames: f64::from(frames), seconds: f64::from(seconds) }
    }

    /// As a video's header states it.
    pub(super) fn fraction(self) -> (u32, u32) {
        let whole = |value: f64| value.fract() == 0.0 && value <= f64::from(u32::MAX);
        if whole(self.frames) && whole(self.seconds) {
            return (self.frames as u32, self.seconds as u32);
        }
        ((1000.0 * self.frames / self.seconds).round().max(1.0) as u32, 1000)
    }
}

/// Reads `25`, `29.97` and `30000/1001`.
impl FromStr for Rate {
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

/// The frames' times: an even rate, or a list.
#[derive(Debug)]
pub(super) struct Times {
    rate: Rate,
    listed: Option<(PathBuf, Vec<f64>)>,
    start_s: f64,
}

impl Times {
    pub(super) fn even(rate: Rate, start_s: f64) -> Self {
        Self { rate, listed: None, start_s }
    }

    /// The times of a file: EuRoC's `#timestamp [ns],filename`, or one in seconds a line.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Format`] naming the line that does not begin with a number, for a unit that is not known,
    /// for a file without a time, or for another number of times than there are frames, where that is known.
    pub(super) fn read(path: &Path, frames: Option<u64>, start_s: f64) -> Result<Self> {
        let mut text = String::new();
        std::fs::File::open(path)
            .and_then(|file| file.take(MAX_BYTES).read_to_string(&mut text))
            .map_err(|source| Error::io(path, source))?;
        let times = parse(path, &text)?;
        if let Some(frames) = frames.filter(|frames| *frames != times.len() as u64) {
            return Err(miscounted(path, times.len(), format_args!("{frames}, one for each frame")));
        }
        // Of a video of what is left on show.
        let span = times[times.len() - 1] - times[0];
        let per_second = (times.len() - 1) as f64 / span;
        let frames = if (0.001..=1e6).contains(&per_second) { per_second } else { Rate::DEFAULT.frames };
        Ok(Self { rate: Rate { frames, seconds: 1.0 }, listed: Some((path.to_owned(), times)), start_s })
    }

    /// The rate, or the mean one.
    pub(super) fn rate(&self) -> Rate {
        self.rate
    }

    /// The time of the frame of a number.
    pub(super) fn of(&self, number: u64) -> Result<f64> {
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

    /// Checks that no time is left over after so many frames.
    pub(super) fn check_end(&self, frames: u64) -> Result<()> {
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

fn parse(path: &Path, text: &str) -> Result<Vec<f64>> {
    let mut times = Vec::new();
    let mut per_second = 1.0;
    for (number, line) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let first = line.split(',').next().unwrap_or_default().trim();
        if first.is_empty() {
            continue;
        }
        let wrong = |expected: &str| {
            let shown: String = first.chars().take(60).collect();
            Err(Error::format(path, "frame times", format!("{shown:?} in line {number}"), expected))
        };
        match first.parse::<f64>() {
            Ok(time) if time.is_finite() => times.push(time / per_second),
            Err(_) if times.is_empty() => {
                let Some(unit) = unit(first) else { return wrong("#timestamp [ns], or a time in seconds") };
                per_second = unit;
            }
            _ => return wrong("a finite number"),
        }
    }
    if times.is_empty() {
        return Err(miscounted(path, 0, "at least 1"));
    }
    Ok(times)
}

/// Units in a second, of a header such as `#timestamp [ns]` or `time_s`.
fn unit(header: &str) -> Option<f64> {
    let name = header.trim_start_matches('#').trim().to_lowercase();
    if !(name.starts_with('t') || name.starts_with("stamp")) {
        return None;
    }
    let unit = name.split(['[', '(', '_', ' ']).next_back().unwrap_or_default();
    match unit.trim_end_matches([']', ')']) {
        "ns" => Some(1e9),
        "us" | "µs" => Some(1e6),
        "ms" => Some(1e3),
        "s" | "sec" => Some(1.0),
        unit if unit == name => Some(1.0),
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_a_number_or_a_fraction() {
        for (text, fraction) in [("25", (25, 1)), ("30000/1001", (30000, 1001))] {
            assert_eq!(text.parse::<Rate>().unwrap(), Rate::of_fraction(fraction));
            assert_eq!(Rate::of_fraction(fraction).fraction(), fraction);
        }
        assert_eq!("29.97".parse::<Rate>().unwrap().fraction(), (29970, 1000));
        for text in ["0", "-1", "NaN", "inf", "x", "1/0", "2e6", ""] {
            assert!(text.parse::<Rate>().is_err(), "{text}");
        }
    }

    #[test]
    fn lists_state_their_unit() {
        let of = |text: &str| parse(Path::new("t.csv"), text);
        assert_eq!(
            of("#timestamp [ns],filename\n1500000000,a.png\n\n2000000000,b.png\n").unwrap(),
            [1.5, 2.0]
        );
        assert_eq!(of("0.5\n0.75\n").unwrap(), [0.5, 0.75]);
        assert_eq!(of("time_s\n0.5\n").unwrap(), [0.5]);
        assert_eq!(of("timestamp\n0.5\n").unwrap(), [0.5]);
        for (text, words) in [
            ("", "number of frame times is 0"),
            ("name\n1\n", "\"name\" in line 1"),
            ("1\nx\n", "\"x\" in line 2"),
            ("1\nNaN\n", "\"NaN\" in line 2"),
            ("#timestamp [h]\n1\n", "in line 1"),
        ] {
            let found = of(text).unwrap_err().to_string();
            assert!(found.contains(words), "{text}: {found}");
        }
    }
}
