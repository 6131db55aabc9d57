//! The 64-bit FNV-1a hash of G. Fowler, L. C. Noll and K.-P. Vo, for digests that are written to files.

/// The hash of the bytes added so far.
pub(crate) struct Fnv1a(u64);

impl Default for Fnv1a {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv1a {
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// The hash as 16 hexadecimal digits.
    pub(crate) fn text(&self) -> String {
        format!("{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_fnv_1a() {
        // The published hashes of these strings.
        for (text, expected) in [("a", "af63dc4c8601ec8c"), ("foobar", "85944171f73967e8")] {
            let mut hash = Fnv1a::default();
            text.split_inclusive('o').for_each(|part| hash.add(part.as_bytes()));
            assert_eq!(hash.text(), expected, "{text}");
        }
    }
}
