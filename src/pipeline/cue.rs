//! The cue: a pipeline's result for a frame.

use std::time::Duration;

use glam::{DMat3, DVec3};

use crate::frame::FlowField;
use crate::imu::GyroFault;
use crate::sphere::{Heading, Sectors, Threat};

/// A pipeline's result for a frame. It borrows from the pipeline; [`Cue::into_owned`] makes a copy that does not.
#[derive(Clone, Copy, Debug)]
pub struct Cue<'a> {
    /// The frame's number, counted from 0 over the pipeline's life.
    pub frame: u64,
    /// The frame's time in seconds, as the caller gave it.
    pub time_s: f64,
    /// Seconds since the previous frame. `None` for a first frame.
    pub interval_s: Option<f64>,
    /// The reason why the cue must not be used; `None` if it is valid. The other fields of an invalid cue are for
    /// diagnosis only.
    pub invalid: Option<Invalid>,
    /// The camera's rotation since the previous frame, where a gyro measured it: it takes a bearing in the camera's
    /// frame at this exposure into its frame at the previous one.
    pub prev_from_cur: Option<DMat3>,
    /// The residual rotation: the camera's angular rate that the flow shows and the gyro does not, rad/s in the
    /// camera's frame, such as a gyro's bias. `None` without a gyro, and where too little is seen to estimate it.
    pub residual_rotation_rad_s: Option<DVec3>,
    /// The direction in which the camera moves.
    pub heading: Heading,
    /// The sectors of the view.
    pub sectors: &'a Sectors,
    /// The threat that will be met first, if there is one.
    pub threat: Option<Threat>,
    /// The flow from this frame back to the previous one, if it is read: one displacement per pixel of the ideal image,
    /// in pixels. With [`Derotation::Before`](crate::sphere::Derotation::Before) the camera's rotation is not in it.
    pub flow: Option<&'a FlowField>,
    /// Nearness rate, divergence, standard error of the nearness rate, and confidence of each cell, if
    /// [`ExtraOutputs::looming`] asks for them. Layout: rows of cells from the top; in each row the four channels one
    /// after the other, each padded to a multiple of four values. Rates are per frame, confidence is 0 to 1.
    ///
    /// [`ExtraOutputs::looming`]: crate::sphere::ExtraOutputs::looming
    pub looming: Option<&'a [f32]>,
    /// Confidence, place (x, y), rate (ẋ, ẏ) and confidence in every direction of each cell, if [`ExtraOutputs::cells`](crate::sphere::ExtraOutputs::cells) asks for them: six channels, laid
    /// out as [`Cue::looming`]. Places are in the plane at unit distance from the ideal camera, rates in its units per
    /// frame, confidences are 0 to 1. The first confidence decides what counts; it differs from the last only with
    /// [`Sphere::directional`](crate::sphere::Sphere::directional).
    pub cells: Option<&'a [f32]>,
    /// The flow on the view sphere at each pixel, if
    /// [`ExtraOutputs::spherical_flow`](crate::sphere::ExtraOutputs::spherical_flow) asks for it: three channels (x, y,
    /// z of the camera's frame) in radians per frame, laid out as [`Cue::looming`] with pixels in place of cells.
    pub spherical_flow: Option<&'a [f32]>,
    /// Time from the submit to the return of the wait.
    pub latency: Duration,
}

impl Cue<'_> {
    /// A copy that owns its data, to keep or to send to another thread. It copies the sectors, and the flow and the
    /// extra outputs where they are read.
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

/// A [`Cue`] that owns its data. Each field is the cue's field of the same name.
#[derive(Clone, Debug)]
pub struct OwnedCue {
    /// The frame's number: [`Cue::frame`].
    pub frame: u64,
    /// The frame's time: [`Cue::time_s`].
    pub time_s: f64,
    /// Seconds since the previous frame: [`Cue::interval_s`].
    pub interval_s: Option<f64>,
    /// The reason why the cue must not be used: [`Cue::invalid`].
    pub invalid: Option<Invalid>,
    /// The camera's rotation since the previous frame: [`Cue::prev_from_cur`].
    pub prev_from_cur: Option<DMat3>,
    /// The residual rotation, rad/s: [`Cue::residual_rotation_rad_s`].
    pub residual_rotation_rad_s: Option<DVec3>,
    /// The direction of motion: [`Cue::heading`].
    pub heading: Heading,
    /// The sectors of the view: [`Cue::sectors`].
    pub sectors: Sectors,
    /// The threat that will be met first: [`Cue::threat`].
    pub threat: Option<Threat>,
    /// The flow back to the previous frame, pixels: [`Cue::flow`].
    pub flow: Option<FlowField>,
    /// Nearness rate and divergence of each cell: [`Cue::looming`].
    pub looming: Option<Vec<f32>>,
    /// The flow of each cell: [`Cue::cells`].
    pub cells: Option<Vec<f32>>,
    /// The flow on the view sphere: [`Cue::spherical_flow`].
    pub spherical_flow: Option<Vec<f32>>,
    /// Time from submit until the cue was there: [`Cue::latency`].
    pub latency: Duration,
}

impl OwnedCue {
    /// A borrowing view, as the other parts of this crate take it.
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

/// The reason why a cue must not be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error, Copy)]
#[non_exhaustive]
pub enum Invalid {
    /// There is no previous frame.
    #[error("no previous frame")]
    First,
    /// The time between the two frames is out of range.
    #[error("{interval_s:.6} s since the previous frame, expected above 0 and at most {limit_s} s")]
    Interval {
        /// Seconds since the previous frame.
        interval_s: f64,
        /// The longest time allowed.
        limit_s: f64,
    },
    /// The gyro's samples do not give the rotation between the two frames.
    #[error("gyro: {0}")]
    Gyro(GyroFault),
    /// The image equals the previous one bit for bit: the camera delivers no new images.
    #[error("the image is identical to the previous one")]
    Frozen,
    /// The flow shows a rotation that the gyro does not.
    #[error(
        "the flow shows a rotation of {found_rad_s:.3} rad/s that the gyro does not, expected at most {most_rad_s}"
    )]
    Turn {
        /// The residual rotation, rad/s.
        found_rad_s: f64,
        /// The limit, [`PipelineConfig::max_remaining_rad_s`](super::PipelineConfig::max_remaining_rad_s).
        most_rad_s: f64,
    },
    /// Too little of the view is trusted.
    #[error("{found:.3} of the view is trusted, expected at least {least}")]
    Coverage {
        /// The share of the view whose flow is trusted, 0 to 1.
        found: f64,
        /// The limit, [`PipelineConfig::least_coverage`](super::PipelineConfig::least_coverage).
        least: f64,
    },
    /// The previous frame was lost, and the flow leads from an earlier one.
    #[error("the previous frame was lost")]
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

/// The kind of an [`Invalid`], without its values, to count and to send.
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

    /// The name in text and JSON: one word in lower case.
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
        // `Debug` prints every field of a cue.
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
