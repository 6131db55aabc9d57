//! Faults of the camera, the gyro and the device during a flight.

use std::fmt;
use std::str::FromStr;

use super::sensor::Sensor;
use crate::error::{Error, Result};
use crate::sim::vehicle::MAX_BIAS_RAD_S;

/// The kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum FaultKind {
    /// The camera repeats its last image.
    Frozen,
    /// The images are black.
    Black,
    /// The given share of the frames is dropped, 0 to 1. As text 0.2 by default.
    Dropped(f64),
    /// The gyro sends no samples.
    GyroLost,
    /// The gyro has this bias about each axis, rad/s, within ±[`MAX_BIAS_RAD_S`]. As text in degrees per second, 5 by
    /// default.
    GyroBias(f64),
    /// The frames' times are NaN.
    NotANumber,
    /// The device that computes the flow is destroyed. The fault has no end: the engine reopens the device the first
    /// time, but not a second time (see [`OnLoss`](crate::OnLoss)).
    DeviceLost,
}

/// A fault with its interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fault {
    /// The kind.
    pub kind: FaultKind,
    /// The beginning, in seconds of flight.
    pub from_s: f64,
    /// The end, exclusive, in seconds of flight; infinite for the rest of the flight.
    pub until_s: f64,
}

impl Fault {
    /// Checks the times, and the share or the bias. The loss of the device has no end.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value out of range.
    pub fn validate(&self) -> Result<()> {
        if !(self.from_s >= 0.0 && self.until_s > self.from_s) {
            let found = format_args!("{} to {} s", self.from_s, self.until_s);
            return Err(Error::parameter("fault", found, "from 0 or later until after that"));
        }
        match self.kind {
            FaultKind::DeviceLost if self.until_s.is_finite() => Err(Error::parameter(
                "end of device-lost",
                format_args!("{} s", self.until_s),
                "none, as the device is opened again",
            )),
            FaultKind::Dropped(share) if !(0.0..=1.0).contains(&share) => {
                Err(Error::parameter("share of dropped frames", share, "0 to 1"))
            }
            FaultKind::GyroBias(bias_rad_s) if !(bias_rad_s.abs() <= MAX_BIAS_RAD_S) => {
                let expected = format!("within ±{:.0} °/s", MAX_BIAS_RAD_S.to_degrees());
                // Rounded to what was given: converting degrees to radians and back changes the last digits.
                let found = format_args!("{} °/s", (1e6 * bias_rad_s.to_degrees()).round() / 1e6);
                Err(Error::parameter("gyro bias", found, expected))
            }
            _ => Ok(()),
        }
    }

    /// Checks that the fault has an effect on a flight by this sensor. Camera faults need images. The true depth
    /// depends on whether there are gyro samples, but not on their values.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the fault and the sensor.
    pub fn check(&self, sensor: Sensor) -> Result<()> {
        let expected = match self.kind {
            FaultKind::GyroLost => return Ok(()),
            FaultKind::GyroBias(_) if sensor != Sensor::Depth => return Ok(()),
            FaultKind::GyroBias(_) => "the sensor flow, noisy-flow or images, which a bias affects",
            _ if sensor == Sensor::Images => return Ok(()),
            _ => "a gyro fault, or the sensor images",
        };
        Err(Error::parameter("fault", format_args!("{self} with the sensor {sensor}"), expected))
    }

    /// Whether the fault is active at a time.
    pub fn acts(&self, time_s: f64) -> bool {
        (self.from_s..self.until_s).contains(&time_s)
    }
}

/// The syntax of a fault, for error messages.
const SYNTAX: &str = "KIND or KIND:FROM or KIND:FROM..UNTIL in seconds, KIND one of frozen, black, dropped[=SHARE], \
                      gyro-lost, gyro-bias[=DEG_S], nan, device-lost";

impl FromStr for Fault {
    type Err = Error;

    /// Parses `KIND`, `KIND:FROM` or `KIND:FROM..UNTIL`, such as `black:2..3` or `dropped=0.2`. `dropped` alone is a
    /// share of 0.2, `gyro-bias` alone 5 °/s.
    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::parameter("fault", text, SYNTAX);
        let (kind, times) = text.split_once(':').unwrap_or((text, "0"));
        let (name, value) = kind.split_once('=').map_or((kind, None), |(name, value)| (name, Some(value)));
        let number = |text: &str| text.parse::<f64>().ok().filter(|n| n.is_finite()).ok_or_else(wrong);
        let value = value.map(number).transpose()?;
        let kind = match (name, value) {
            ("frozen", None) => FaultKind::Frozen,
            ("black", None) => FaultKind::Black,
            ("dropped", share) => FaultKind::Dropped(share.unwrap_or(0.2)),
            ("gyro-lost", None) => FaultKind::GyroLost,
            ("gyro-bias", bias_deg_s) => FaultKind::GyroBias(bias_deg_s.unwrap_or(5.0).to_radians()),
            ("nan", None) => FaultKind::NotANumber,
            ("device-lost", None) => FaultKind::DeviceLost,
            _ => return Err(wrong()),
        };
        let (from_s, until_s) = match times.split_once("..") {
            Some((from, until)) => (number(from)?, number(until)?),
            None => (number(times)?, f64::INFINITY),
        };
        let fault = Self { kind, from_s, until_s };
        fault.validate()?;
        Ok(fault)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            FaultKind::Frozen => write!(f, "frozen"),
            FaultKind::Black => write!(f, "black"),
            FaultKind::Dropped(share) => write!(f, "dropped={share}"),
            FaultKind::GyroLost => write!(f, "gyro-lost"),
            FaultKind::GyroBias(bias) => write!(f, "gyro-bias={}", bias.to_degrees()),
            FaultKind::NotANumber => write!(f, "nan"),
            FaultKind::DeviceLost => write!(f, "device-lost"),
        }?;
        write!(f, ":{}", self.from_s)?;
        if self.until_s.is_finite() { write!(f, "..{}", self.until_s) } else { Ok(()) }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for text in
            ["frozen:1..2.5", "black:0", "dropped=0.2:3", "gyro-lost:2..3", "gyro-bias=5:1", "nan:4..4.1"]
        {
            let fault: Fault = text.parse().unwrap();
            let back: Fault = fault.to_string().parse().unwrap();
            assert_eq!(fault, back, "{text}");
        }
        let bias: Fault = "gyro-bias".parse().unwrap();
        assert_eq!(bias.kind, FaultKind::GyroBias(5_f64.to_radians()));
        assert!(bias.acts(0.0) && bias.acts(1e9));
    }

    #[test]
    fn a_fault_that_the_sensor_shows_nothing_of_is_refused() {
        let check = |text: &str, sensor| text.parse::<Fault>().unwrap().check(sensor);
        for sensor in [Sensor::Depth, Sensor::Flow, Sensor::NoisyFlow, Sensor::Images] {
            assert!(check("gyro-lost", sensor).is_ok());
            assert_eq!(check("gyro-bias=5", sensor).is_ok(), sensor != Sensor::Depth);
            for text in ["frozen", "black", "dropped", "nan", "device-lost"] {
                assert_eq!(check(text, sensor).is_ok(), sensor == Sensor::Images, "{text}");
            }
        }
        let error = check("gyro-bias=5:1..2", Sensor::Depth).unwrap_err().to_string();
        assert!(error.starts_with("fault is gyro-bias=5:1..2 with the sensor depth, expected"), "{error}");
    }

    #[test]
    fn what_is_none_is_an_error_of_one_line() {
        for text in [
            "",
            "froze",
            "frozen=1",
            "black:2..1",
            "black:x",
            "dropped=1.5",
            "dropped=nan",
            "nan:-1",
            "gyro-bias=2006",
            "device-lost:2..4",
        ] {
            let error = text.parse::<Fault>().unwrap_err().to_string();
            assert!(["fault", "share", "bias", "end"].iter().any(|word| error.contains(word)), "{error}");
            assert!(!error.contains('\n'), "{error}");
        }
        let error = "gyro-bias=1e9".parse::<Fault>().unwrap_err().to_string();
        assert_eq!(error, "gyro bias is 1000000000 °/s, expected within ±2005 °/s");
    }
}
