//! Pseudo-random numbers, the same on both sides and on every machine.

/// The finaliser of MurmurHash3, of a number that is not 0.
#[inline(always)]
pub(crate) fn scrambled(number: u32) -> u32 {
    finalised(number ^ 0x5bd1_e995)
}

/// The finaliser of MurmurHash3; 0 stays 0.
#[inline(always)]
pub(crate) fn finalised(mut hash: u32) -> u32 {
    hash ^= hash >> 16;
    hash = hash.wrapping_mul(0x85eb_ca6b);
    hash ^= hash >> 13;
    hash = hash.wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}
