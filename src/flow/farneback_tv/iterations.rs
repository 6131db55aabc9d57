//! How often a level writes its flow.

use super::FarnebackTv;

/// The warps of a computed level.
pub(super) fn warps(config: &FarnebackTv, k: usize, finest: usize) -> u32 {
    if k == finest { config.warps } else { config.coarse_warps }
}

/// The writes of the flow on a computed level up to the last warp: the windowed increment, and two runs of sweeps per warp.
pub(super) fn warped(config: &FarnebackTv, k: usize, finest: usize) -> u32 {
    1 + 2 * warps(config, k, finest)
}

/// The writes of the flow on a level: those up to the last warp, the non-local step, and, on the finest one, the previous flow's
/// part.
pub(super) fn iterations(config: &FarnebackTv, k: usize, finest: usize, nonlocal: usize) -> u32 {
    let carries = k == finest && config.carry > 0.0;
    let steps = u32::from(k < finest + nonlocal) + u32::from(carries);
    if k < finest { 0 } else { warped(config, k, finest) + steps }
}
