//! Cues as JSON: what `viewsphere run --json-lines` writes, one object per line, and what any program can write or read
//! with these types. The feature `serde` turns this module on.
//!
//! ```
//! use viewsphere::wire::{CueMessage, Timing};
//! # use viewsphere::camera::{Camera, Lens};
//! # use viewsphere::frame::{Frame, PixelFormat, Size};
//! # use viewsphere::{Backend, Pipeline, PipelineConfig};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let size = Size::new(64, 48);
//! # let camera = Camera { size, f_u: 40.0, f_v: 40.0, u_0: 31.5, v_0: 23.5, lens: Lens::NONE };
//! # let mut pipeline = Pipeline::new(Backend::Cpu, &camera, &PipelineConfig::default())?;
//! # let pixels = [128; 64 * 48];
//! # let cue = pipeline.process(&Frame::new(size, PixelFormat::Gray8, &pixels)?, 0.0)?;
//! let message = CueMessage::new(0, &cue, Timing::default(), false);
//! let line = serde_json::to_string(&message)?;
//! assert!(line.starts_with(r#"{"frame":0,"time_s":0.0,"valid":false,"invalid_kind":"first","#));
//! assert_eq!(serde_json::from_str::<CueMessage>(&line)?, message);
//! # Ok(())
//! # }
//! ```
//!
//! [`CUE_SCHEMA`] is the JSON Schema of an object. Unknown values are `null`. Later versions may add members, so a
//! reader should ignore members that it does not know.

use serde::{Deserialize, Serialize};

use crate::pipeline::{Cue, InvalidKind};
use crate::sphere::{Sectors, angles_rad};

/// The JSON Schema (draft 2020-12) of [`CueMessage`], which is `docs/cue.schema.json`.
pub const CUE_SCHEMA: &str = include_str!("../docs/cue.schema.json");

/// A frame's cue. Angles are rounded to 0.01°, times to 1 ms, rates to 0.0001 /s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CueMessage {
    /// The frame's number in its source, from 0.
    pub frame: u64,
    /// The frame's time, seconds.
    pub time_s: f64,
    /// Whether the cue may be used. The other members of an invalid cue are for diagnosis only; its sectors have no
    /// times.
    pub valid: bool,
    /// The kind of the reason why the cue is invalid; `null` if it is valid.
    pub invalid_kind: Option<InvalidKind>,
    /// The reason as text; `null` if the cue is valid.
    pub invalid: Option<String>,
    /// The direction of motion; `null` if it is unknown.
    pub heading: Option<HeadingMessage>,
    /// The threat that will be met first; `null` without a threat.
    pub threat: Option<ThreatMessage>,
    /// The sectors of the view.
    pub sectors: SectorsMessage,
    /// The frame's timing: the only member that differs from run to run.
    pub timing: Timing,
}

/// A direction in the camera's frame: azimuth is positive to the right, elevation positive up, both 0 on the optical
/// axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadingMessage {
    /// Azimuth, degrees.
    pub azimuth_deg: f64,
    /// Elevation, degrees.
    pub elevation_deg: f64,
    /// Standard error of the direction, degrees.
    pub error_deg: f64,
}

/// A threat: connected sectors on a collision course.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreatMessage {
    /// Azimuth of its centre, degrees.
    pub azimuth_deg: f64,
    /// Elevation of its centre, degrees.
    pub elevation_deg: f64,
    /// Time to contact with its nearest part, seconds.
    pub time_s: f64,
    /// Number of sectors that it fills.
    pub sectors: usize,
    /// Whether it was seen in as many consecutive frames as an alarm needs.
    pub alarm: bool,
}

/// The sectors' values in lists of `columns` × `rows`, row by row from the upper left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectorsMessage {
    /// Sectors in a row.
    pub columns: usize,
    /// Rows of sectors.
    pub rows: usize,
    /// Azimuths of the left and the right border of the view, degrees.
    pub azimuth_deg: [f64; 2],
    /// Elevations of the upper and the lower border of the view, degrees.
    pub elevation_deg: [f64; 2],
    /// Median time to contact, seconds; `null` where nothing is known or nothing comes nearer.
    pub ttc_s: Vec<Option<f64>>,
    /// Share of the sector whose flow is trusted, 0 to 1.
    pub coverage: Vec<f64>,
    /// Further lists, flattened into the same object.
    #[serde(flatten)]
    pub detail: Option<SectorDetail>,
}

/// Further values of the sectors, in lists with the layout of [`SectorsMessage`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectorDetail {
    /// Lower quantile of the time to contact, seconds.
    pub ttc_early_s: Vec<Option<f64>>,
    /// Upper quantile of the time to contact, seconds.
    pub ttc_late_s: Vec<Option<f64>>,
    /// Median nearness rate, 1/s; negative where things recede.
    pub nearness_rate_hz: Vec<Option<f64>>,
    /// Upper quantile of the positive part of the divergence, 1/s.
    pub divergence_hz: Vec<Option<f64>>,
    /// Mean confidence of the trusted share, 0 to 1.
    pub confidence: Vec<f64>,
}

/// The timing of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Time from the frame's arrival until the cue, milliseconds.
    pub age_ms: f64,
    /// Time from the frame's submission until the cue, milliseconds.
    pub latency_ms: f64,
    /// Number of frames dropped so far.
    pub dropped: u64,
}

impl CueMessage {
    /// The message of a cue, for the frame of this number in its source; with the [`SectorDetail`] if `detail` is true.
    pub fn new(frame: u64, cue: &Cue<'_>, timing: Timing, detail: bool) -> Self {
        let Timing { age_ms, latency_ms, dropped } = timing;
        let heading = Some(cue.heading).filter(|heading| heading.is_known()).map(|heading| {
            let [azimuth, elevation] = angles_rad(heading.direction);
            HeadingMessage {
                azimuth_deg: degrees(azimuth),
                elevation_deg: degrees(elevation),
                error_deg: degrees(heading.error_rad),
            }
        });
        let threat = cue.threat.map(|threat| ThreatMessage {
            azimuth_deg: degrees(threat.azimuth_rad),
            elevation_deg: degrees(threat.elevation_rad),
            time_s: round(threat.time_s, 3),
            sectors: threat.sectors,
            alarm: threat.alarm,
        });
        Self {
            frame,
            time_s: round(cue.time_s, 9),
            valid: cue.invalid.is_none(),
            invalid_kind: cue.invalid.map(|reason| reason.kind()),
            invalid: cue.invalid.map(|reason| reason.to_string()),
            heading,
            threat,
            sectors: SectorsMessage::new(cue.sectors, cue.invalid.is_none(), detail),
            timing: Timing { age_ms: round(age_ms, 3), latency_ms: round(latency_ms, 3), dropped },
        }
    }
}

impl SectorsMessage {
    /// An invalid cue has no times and no rates, so that none can be mistaken for valid ones.
    fn new(all: &Sectors, valid: bool, detail: bool) -> Self {
        let times = |which: usize| {
            let of = |sector| all.time_to_contact_s(sector)[which].filter(|_| valid);
            all.sectors.iter().map(|sector| of(sector).map(|time| round(time, 3))).collect()
        };
        let rates = |rate: fn(&crate::sphere::Sector) -> f64| {
            let known = all.sectors.iter().map(|sector| Some(sector).filter(|s| valid && s.is_known()));
            known.map(|sector| sector.map(|sector| round(rate(sector), 4))).collect()
        };
        let grid = &all.grid;
        Self {
            columns: grid.columns,
            rows: grid.rows,
            azimuth_deg: grid.azimuth_rad.map(degrees),
            elevation_deg: grid.elevation_rad.map(degrees),
            ttc_s: times(1),
            coverage: all.sectors.iter().map(|sector| round(sector.coverage, 2)).collect(),
            detail: detail.then(|| SectorDetail {
                ttc_early_s: times(0),
                ttc_late_s: times(2),
                nearness_rate_hz: rates(|sector| sector.nearness_rate_hz[1]),
                divergence_hz: rates(|sector| sector.divergence_hz),
                confidence: all.sectors.iter().map(|sector| round(sector.confidence, 2)).collect(),
            }),
        }
    }
}

fn degrees(radians: f64) -> f64 {
    round(radians.to_degrees(), 2)
}

/// Rounds to a number of decimals, so that lines stay short.
fn round(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    let rounded = (value * scale).round() / scale;
    // Without this, −0 would be written as such.
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests;
