//! Random numbers of the wind and of each sensor.

use glam::DVec3;

use crate::sim::Random;

/// Streams from here on are those of vehicles: the letters of the word. Worlds count theirs from 0.
const FIRST: u64 = 0x7665_6869_636c_6500;

/// What draws: with the same seed for a whole flight and its world, none tells of another.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stream {
    Gusts,
    Gyro,
    Airspeed,
    Vanes,
}

impl Stream {
    pub(super) fn of(self, seed: u64) -> Random {
        Random::new(seed).fork(FIRST + self as u64)
    }
}

/// Three independent draws of mean 0 and variance 1.
pub(super) fn normal(random: &mut Random) -> DVec3 {
    let [x, y, z] = std::array::from_fn(|_| random.normal());
    DVec3::new(x, y, z)
}
