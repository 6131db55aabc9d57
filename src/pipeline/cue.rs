//! What a pipeline says of a frame.

use std::time::Duration;

use glam::{DMat3, DVec3};

use crate::frame::FlowField;
use crate::imu::GyroFault;
use crate::sphere::{Heading, Sectors, Threat};

/// What a pipeline says of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Cue<'a> {
    /// The frame's number, counted from 0 over the pipeline's life.
    pub frame: u64,
    /// The frame's time, as it was given.
    pub time_s: f64,
    /// Seconds since the frame before.
    pub interval_s: Option<f64>,
    /// Why the cue is not to be used; none if it is. What else is there may still be looked at.
    pub invalid: Option<Invalid>,
    /// How the camera turned since the frame before, where a gyro tells.
    pub prev_from_cur: Option<DMat3>,
    /// The camera's angular rate that its flow shows beside what the gyro told, rad/s in the camera's frame: a bias. None
    /// without a gyro, and where too little is seen to tell.
    pub remaining_turn_rad_s: Option<DVec3>,
    /// Which way the camera moves.
    pub heading: Heading,
    /// What each sector of the view says.
    pub sectors: &'a Sectors,
    /// What will be met first, if anything soon.
    pub threat: Option<Threat>,
    /// The flow from this frame back to the one before in pixels of the ideal picture, if it is read. With
    /// [`Derotation::Before`](crate::sphere::Derotation::Before) the camera's turn is not in it.
    pub flow: Option<&'a FlowField>,
    /// Nearness rate, divergence, error and trust of each cell, if [`Fields::looming`] asks for them: rows of cells, in
    /// each row the four channels one after the other, each padded to a multiple of four values. Rates are per frame.
    ///
    /// [`Fields::looming`]: crate::sphere::Fields::looming
    pub looming: Option<&'a [f32]>,
    /// Trust, place (2) and rate (2) of each cell, if [`Fields::cells`](crate::sphere::Fields::cells) asks for them: five
    /// channels, laid out as [`Cue::looming`].
    pub cells: Option<&'a [f32]>,
    /// The flow on the view sphere of each pixel, if [`Fields::tangent`](crate::sphere::Fields::tangent) asks for it: three
    /// channels in radians, laid out as [`Cue::looming`] with pixels for cells.
    pub tangent: Option<&'a [f32]>,
    /// Time from submit until now.
    pub latency: Duration,
}

/// Why a cue is not to be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error, Copy)]
#[non_exhaustive]
pub enum Invalid {
    /// There is no frame before it.
    #[error("there is no frame before it")]
    First,
    /// The time between the frames is out of range.
    #[error("{interval_s:.6} s since the frame before, expected above 0 and at most {limit_s} s")]
    Interval {
        /// Seconds since the frame before.
        interval_s: f64,
        /// The longest time allowed.
        limit_s: f64,
    },
    /// The gyro does not say how the camera turned.
    #[error("gyro: {0}")]
    Gyro(GyroFault),
    /// The picture is that of the frame before, to the last bit: the camera has stopped giving new ones.
    #[error("the picture is the one before again")]
    Frozen,
    /// The flow shows a turn that the gyro has not told.
    #[error(
        "the flow turns by {found_rad_s:.3} rad/s beside what the gyro tells, expected at most {most_rad_s}"
    )]
    Turn {
        /// The rate that is left.
        found_rad_s: f64,
        /// The highest that is allowed.
        most_rad_s: f64,
    },
    /// Too little of the view is trusted.
    #[error("{found:.3} of the view is trusted, expected at least {least}")]
    Coverage {
        /// The share that is trusted.
        found: f64,
        /// The share that is needed.
        least: f64,
    },
    /// The frame before was lost, and the flow leads from another one.
    #[error("the frame before was lost")]
    Lost,
}
