use std::fmt::{self, Debug, Write};

/// The fingerprint of a configuration and this crate's version: 16 hexadecimal digits, FNV-1a over the [`Debug`]
/// output. Equal configurations of the same version have the same fingerprint.
pub fn fingerprint(configuration: &impl Debug) -> String {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    // Writing to a hash cannot fail.
    let _ = write!(hash, "{} {configuration:?}", env!("CARGO_PKG_VERSION"));
    format!("{:016x}", hash.0)
}

struct Fnv(u64);

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::flight::FlightConfig;

    #[test]
    fn the_hash_is_fnv_1a() {
        // The values of Fowler, Noll and Vo for these strings.
        for (text, expected) in [("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)] {
            let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
            assert!(hash.write_str(text).is_ok());
            assert_eq!(hash.0, expected, "{text}");
        }
    }

    #[test]
    fn any_part_of_a_configuration_counts() {
        let config = FlightConfig::default();
        let mut other = config.clone();
        other.steer.weights.bank += 1e-12;
        assert_eq!(fingerprint(&config), fingerprint(&config.clone()));
        assert_ne!(fingerprint(&config), fingerprint(&other));
    }
}
