//! The names of policies, measures of danger and readings.

use super::{Danger, Policy, Reading};
use crate::named::named;

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

impl Reading {
    /// All readings.
    pub const ALL: [Self; 2] = [Self::Sectors, Self::Columns];

    /// The name: `sectors` or `columns`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sectors => "sectors",
            Self::Columns => "columns",
        }
    }
}

named!(Policy, "policy");
named!(Danger, "danger");
named!(Reading, "reading");

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
        for reading in Reading::ALL {
            assert_eq!(reading.to_string().parse::<Reading>().unwrap(), reading);
        }
        let error = "Arc".parse::<Policy>().unwrap_err().to_string();
        assert_eq!(error, "policy is \"Arc\", expected none, balance, potential, heading, arc");
    }
}
