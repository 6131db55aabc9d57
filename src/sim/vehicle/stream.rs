//! The random streams of the wind and of each sensor.

use glam::DVec3;

use crate::sim::Random;

/// The first stream number of vehicles: the letters of the word. Worlds count theirs from 0.
const FIRST: u64 = 0x7665_6869_636c_6500;

/// The users of random numbers. Their streams are independent, even with the seed of the flight and its world.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stream {
    Gusts,
    Gyro,
    Airspeed,
    Vanes,
    VerticalSpeed,
}

impl Stream {
    pub(super) fn of(self, seed: u64) -> Random {
        Random::new(seed).fork(FIRST + self as u64)
    }
}

/// Three independent standard normal numbers.
pub(super) fn normal(random: &mut Random) -> DVec3 {
    let [x, y, z] = std::array::from_fn(|_| random.normal());
    DVec3::new(x, y, z)
}
