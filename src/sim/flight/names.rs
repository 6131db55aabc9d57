//! Sensors and outcomes as text.

use std::fmt;
use std::str::FromStr;

use super::{Outcome, Sensor};
use crate::error::{Error, Result};

impl Sensor {
    /// All of them: the ladder from what is known exactly to what a camera gives.
    pub const ALL: [Self; 4] = [Self::Depth, Self::Flow, Self::NoisyFlow, Self::Images];

    /// The name: `depth`, `flow`, `noisy-flow` or `images`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Flow => "flow",
            Self::NoisyFlow => "noisy-flow",
            Self::Images => "images",
        }
    }
}

impl Outcome {
    /// All of them, the best first.
    pub const ALL: [Self; 4] = [Self::Reached, Self::Crashed, Self::LeftBand, Self::TimedOut];

    /// The name: `reached`, `crashed`, `left-band` or `timed-out`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Crashed => "crashed",
            Self::LeftBand => "left-band",
            Self::TimedOut => "timed-out",
        }
    }
}

impl fmt::Display for Sensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Sensor {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let of_name = Self::ALL.into_iter().find(|sensor| sensor.name() == text);
        of_name.ok_or_else(|| Error::parameter("sensor", format_args!("{text:?}"), known()))
    }
}

impl FromStr for Outcome {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let of_name = Self::ALL.into_iter().find(|outcome| outcome.name() == text);
        of_name.ok_or_else(|| Error::parameter("outcome", format_args!("{text:?}"), known()))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for sensor in Sensor::ALL {
            assert_eq!(sensor.to_string().parse::<Sensor>().unwrap(), sensor);
        }
        for outcome in Outcome::ALL {
            assert_eq!(outcome.to_string().parse::<Outcome>().unwrap(), outcome);
        }
        let error = "camera".parse::<Sensor>().unwrap_err().to_string();
        assert_eq!(error, "sensor is \"camera\", expected depth, flow, noisy-flow, images");
    }
}
