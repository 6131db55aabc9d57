use std::fmt;
use std::str::FromStr;

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::sim::flight::{Fault, FaultKind};

/// The faults of a flight: none, one or several. As text `none`, or faults joined by `+`, such as
/// `black:2..3+gyro-lost:4`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults(pub Vec<Fault>);

impl Faults {
    /// Checks that each fault can occur on the backend that computes the flow: only a GPU has a device to destroy.
    /// [`Fault::check`] checks it against the sensor.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the first fault that cannot.
    pub fn check(&self, flow: &Backend) -> Result<()> {
        let destroys = |fault: &&Fault| fault.kind == FaultKind::DeviceLost;
        match self.0.iter().find(destroys) {
            Some(fault) if matches!(flow, Backend::Cpu) => {
                let found = format_args!("{fault} on the CPU");
                Err(Error::parameter("fault", found, "a GPU, whose device can be destroyed"))
            }
            _ => Ok(()),
        }
    }

    /// Whether a fault destroys the device.
    pub fn destroy(&self) -> bool {
        self.0.iter().any(|fault| fault.kind == FaultKind::DeviceLost)
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("none");
        }
        for (i, fault) in self.0.iter().enumerate() {
            write!(f, "{}{fault}", if i > 0 { "+" } else { "" })?;
        }
        Ok(())
    }
}

impl FromStr for Faults {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "none" {
            return Ok(Self::default());
        }
        text.split('+').map(str::parse).collect::<Result<_>>().map(Self)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for (text, count) in [("none", 0), ("black:2..3", 1), ("dropped=0.2:1+gyro-lost:2..3", 2)] {
            let faults: Faults = text.parse().unwrap();
            assert_eq!((faults.to_string().as_str(), faults.0.len()), (text, count));
        }
        assert!("none+black".parse::<Faults>().is_err());
        assert!("".parse::<Faults>().is_err());
    }

    #[test]
    fn a_fault_that_cannot_happen_is_refused() {
        let check = |text: &str| text.parse::<Faults>().unwrap().check(&Backend::Cpu);
        assert!(check("gyro-lost+gyro-bias=5:1..2+black+frozen+nan+dropped").is_ok());
        let error = check("black+device-lost").unwrap_err().to_string();
        assert!(error.contains("on the CPU"), "{error}");
    }
}
