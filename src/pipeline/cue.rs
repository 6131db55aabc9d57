//! What a pipeline says of a frame.

use std::time::Duration;

use glam::{DMat3, DVec3};

use crate::frame::FlowField;
use crate::imu::GyroFault;
use crate::sphere::{Heading, Sectors, Threat};

/// What a pipeline says of a frame. It borrows from the pipeline; [`Cue::into_owned`] makes a copy that does not.
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
    pub residual_rotation_rad_s: Option<DVec3>,
    /// Which way the camera moves.
    pub heading: Heading,
    /// What each sector of the view says.
    pub sectors: &'a Sectors,
    /// What will be met first, if anything soon.
    pub threat: Option<Threat>,
    /// The flow from this frame back to the one before in pixels of the ideal picture, if it is read. With
    /// [`Derotation::Before`](crate::sphere::Derotation::Before) the camera's turn is not in it.
    pub flow: Option<&'a FlowField>,
    /// Nearness rate, divergence, error and confidence of each cell, if [`ExtraOutputs::looming`] asks for them: rows
    /// of cells, in each row the four channels one after the other, each padded to a multiple of four values. Rates are
    /// per frame.
    ///
    /// [`ExtraOutputs::looming`]: crate::sphere::ExtraOutputs::looming
    pub looming: Option<&'a [f32]>,
    /// Confidence, place (2) and rate (2) of each cell, if [`ExtraOutputs::cells`](crate::sphere::ExtraOutputs::cells)
    /// asks for them: five channels, laid out as [`Cue::looming`].
    pub cells: Option<&'a [f32]>,
    /// The flow on the view sphere of each pixel, if
    /// [`ExtraOutputs::spherical_flow`](crate::sphere::ExtraOutputs::spherical_flow) asks for it: three channels in
    /// radians, laid out as [`Cue::looming`] with pixels for cells.
    pub spherical_flow: Option<&'a [f32]>,
    /// Time from submit until now.
    pub latency: Duration,
}

impl Cue<'_> {
    /// A copy that owns its data, to be kept or sent to another thread. It copies the sectors, and the flow and the fields
    /// where they are read.
    pub fn into_owned(self) -> OwnedCue {
        OwnedCue {
            frame: self.frame,
            time_s: self.time_s,
            interval_s: self.interval_s,
            invalid: self.invalid,
            prev_from_cur: self.prev_from_cur,
            residual_rotation_rad_s: self.residual_rotation_rad_s,
            heading: self.heading,
            sectors: self.sectors.clone(),
            threat: self.threat,
            flow: self.flow.cloned(),
            looming: self.looming.map(<[f32]>::to_vec),
            cells: self.cells.map(<[f32]>::to_vec),
            spherical_flow: self.spherical_flow.map(<[f32]>::to_vec),
            latency: self.latency,
        }
    }
}

/// A [`Cue`] that owns its data. Each field is that of the cue of the same name.
#[derive(Clone, Debug)]
pub struct OwnedCue {
    /// The frame's number: [`Cue::frame`].
    pub frame: u64,
    /// The frame's time: [`Cue::time_s`].
    pub time_s: f64,
    /// Seconds since the previous frame: [`Cue::interval_s`].
    pub interval_s: Option<f64>,
    /// Why the cue is not to be used: [`Cue::invalid`].
    pub invalid: Option<Invalid>,
    /// The camera's rotation since the previous frame: [`Cue::prev_from_cur`].
    pub prev_from_cur: Option<DMat3>,
    /// The rotation rate that the gyro does not explain, rad/s: [`Cue::residual_rotation_rad_s`].
    pub residual_rotation_rad_s: Option<DVec3>,
    /// The direction of motion: [`Cue::heading`].
    pub heading: Heading,
    /// The sectors of the view: [`Cue::sectors`].
    pub sectors: Sectors,
    /// What will be met first: [`Cue::threat`].
    pub threat: Option<Threat>,
    /// The flow back to the previous frame, pixels: [`Cue::flow`].
    pub flow: Option<FlowField>,
    /// The rates of each cell: [`Cue::looming`].
    pub looming: Option<Vec<f32>>,
    /// The flow of each cell: [`Cue::cells`].
    pub cells: Option<Vec<f32>>,
    /// The flow on the view sphere: [`Cue::spherical_flow`].
    pub spherical_flow: Option<Vec<f32>>,
    /// Time from submit until the cue was there: [`Cue::latency`].
    pub latency: Duration,
}

impl OwnedCue {
    /// The cue as one that borrows, which is what the other parts of this crate take.
    pub fn cue(&self) -> Cue<'_> {
        Cue {
            frame: self.frame,
            time_s: self.time_s,
            interval_s: self.interval_s,
            invalid: self.invalid,
            prev_from_cur: self.prev_from_cur,
            residual_rotation_rad_s: self.residual_rotation_rad_s,
            heading: self.heading,
            sectors: &self.sectors,
            threat: self.threat,
            flow: self.flow.as_ref(),
            looming: self.looming.as_deref(),
            cells: self.cells.as_deref(),
            spherical_flow: self.spherical_flow.as_deref(),
            latency: self.latency,
        }
    }
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

impl Invalid {
    /// The kind of the reason, without its values.
    pub fn kind(&self) -> InvalidKind {
        match self {
            Self::First => InvalidKind::First,
            Self::Interval { .. } => InvalidKind::Interval,
            Self::Gyro(_) => InvalidKind::Gyro,
            Self::Coverage { .. } => InvalidKind::Coverage,
            Self::Lost => InvalidKind::Lost,
            Self::Frozen => InvalidKind::Frozen,
            Self::Turn { .. } => InvalidKind::Turn,
        }
    }
}

/// The kinds of [`Invalid`], to count and to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum InvalidKind {
    /// [`Invalid::First`].
    First,
    /// [`Invalid::Interval`].
    Interval,
    /// [`Invalid::Gyro`].
    Gyro,
    /// [`Invalid::Coverage`].
    Coverage,
    /// [`Invalid::Lost`].
    Lost,
    /// [`Invalid::Frozen`].
    Frozen,
    /// [`Invalid::Turn`].
    Turn,
}

impl InvalidKind {
    /// Every kind, in the order in which summaries list them.
    pub const ALL: [Self; 7] =
        [Self::First, Self::Interval, Self::Gyro, Self::Coverage, Self::Lost, Self::Frozen, Self::Turn];

    /// Its name in lines and JSON: one word in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Interval => "interval",
            Self::Gyro => "gyro",
            Self::Coverage => "coverage",
            Self::Lost => "lost",
            Self::Frozen => "frozen",
            Self::Turn => "turn",
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Size;
    use crate::sphere::Grid;

    #[test]
    fn an_owned_cue_is_the_cue_and_can_be_sent() {
        fn sent<T: Send + Clone + 'static>(value: T) -> T {
            std::thread::spawn(move || value).join().unwrap()
        }
        let grid = Grid { columns: 2, rows: 1, azimuth_rad: [-0.5, 0.5], elevation_rad: [0.2, -0.2] };
        let flow = FlowField { size: Size::new(1, 1), data: vec![[1.5, -2.0]] };
        let cue = Cue {
            frame: 7,
            time_s: 0.25,
            interval_s: Some(0.03),
            invalid: Some(Invalid::Coverage { found: 0.1, least: 0.2 }),
            prev_from_cur: Some(DMat3::from_rotation_y(0.1)),
            residual_rotation_rad_s: Some(DVec3::X),
            heading: Heading { direction: DVec3::Z, error_rad: 0.01 },
            sectors: &Sectors::unknown(grid),
            threat: Some(Threat {
                azimuth_rad: 0.1,
                elevation_rad: 0.2,
                time_s: 1.5,
                sectors: 2,
                alarm: true,
            }),
            flow: Some(&flow),
            looming: Some(&[1.0, 2.0]),
            cells: None,
            spherical_flow: None,
            latency: Duration::from_millis(4),
        };
        let text = format!("{cue:?}");
        let owned = sent(cue.into_owned());
        // What is printed of a cue is every field of it.
        assert_eq!(format!("{:?}", owned.cue()), text);
        assert_eq!(format!("{:?}", owned.clone().cue()), text);
    }

    #[test]
    fn every_kind_is_listed_once_under_its_own_name() {
        for (at, kind) in InvalidKind::ALL.into_iter().enumerate() {
            assert_eq!(InvalidKind::ALL.iter().position(|other| other.name() == kind.name()), Some(at));
        }
        assert_eq!(Invalid::Turn { found_rad_s: 1.0, most_rad_s: 0.5 }.kind().name(), "turn");
    }
}
