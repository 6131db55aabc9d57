//! The names of policies and measures of danger.

use std::fmt;
use std::str::FromStr;

use super::{Danger, Policy};
use crate::error::{Error, Result};

impl Policy {
    /// All policies, the simplest first.
    pub const ALL: [Self; 5] = [Self::None, Self::Balance, Self::Potential, Self::Heading, Self::Arc];

    /// The name: `none`, `balance`, `potential`, `heading` or `arc`.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Balance => "balance",
            Self::Potential => "potential",
            Self::Heading => "heading",
            Self::Arc => "arc",
        }
    }
}

impl Danger {
    /// All measures of danger.
    pub const ALL: [Self; 3] = [Self::Divergence, Self::Nearness, Self::Blend];

    /// The name: `divergence`, `nearness` or `blend`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Divergence => "divergence",
            Self::Nearness => "nearness",
            Self::Blend => "blend",
        }
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Danger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Policy {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let of_name = Self::ALL.into_iter().find(|policy| policy.name() == text);
        of_name.ok_or_else(|| Error::parameter("policy", format_args!("{text:?}"), known()))
    }
}

impl FromStr for Danger {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let of_name = Self::ALL.into_iter().find(|danger| danger.name() == text);
        of_name.ok_or_else(|| Error::parameter("danger", format_args!("{text:?}"), known()))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for policy in Policy::ALL {
            assert_eq!(policy.to_string().parse::<Policy>().unwrap(), policy);
        }
        for danger in Danger::ALL {
            assert_eq!(danger.to_string().parse::<Danger>().unwrap(), danger);
        }
        let error = "Arc".parse::<Policy>().unwrap_err().to_string();
        assert_eq!(error, "policy is \"Arc\", expected none, balance, potential, heading, arc");
    }
}
