//! What is said of a frame: a line to read, or one of JSON.

use serde::Serialize;

use crate::pipeline::{Cue, Invalid};
use crate::sphere::{Sectors, angles_rad};

/// A frame's cue as JSON. What is not known is `null`.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    frame: u64,
    time_s: f64,
    valid: bool,
    invalid_kind: Option<&'static str>,
    invalid: Option<String>,
    heading: Option<Heading>,
    threat: Option<Threat>,
    sectors: SectorLists,
    timing: Timing,
}

#[derive(Debug, Serialize)]
struct Heading {
    azimuth_deg: f64,
    elevation_deg: f64,
    error_deg: f64,
}

#[derive(Debug, Serialize)]
struct Threat {
    azimuth_deg: f64,
    elevation_deg: f64,
    time_s: f64,
    sectors: usize,
    alarm: bool,
}

/// The sectors' values in lists, row by row from the upper left.
#[derive(Debug, Serialize)]
struct SectorLists {
    columns: usize,
    rows: usize,
    azimuth_deg: [f64; 2],
    elevation_deg: [f64; 2],
    ttc_s: Vec<Option<f64>>,
    coverage: Vec<f64>,
    #[serde(flatten)]
    detail: Option<Detail>,
}

#[derive(Debug, Serialize)]
struct Detail {
    ttc_early_s: Vec<Option<f64>>,
    ttc_late_s: Vec<Option<f64>>,
    nearness_rate_hz: Vec<Option<f64>>,
    divergence_hz: Vec<Option<f64>>,
    confidence: Vec<f64>,
}

/// How the frame went through. This alone differs from run to run.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Timing {
    pub(super) age_ms: f64,
    pub(super) latency_ms: f64,
    pub(super) dropped: u64,
}

impl Line {
    /// What is said of the frame of this number in its source.
    pub(super) fn new(number: u64, cue: &Cue<'_>, timing: Timing, detail: bool) -> Self {
        let Timing { age_ms, latency_ms, dropped } = timing;
        let heading = Some(cue.heading).filter(|heading| heading.is_known()).map(|heading| {
            let [azimuth, elevation] = angles_rad(heading.direction);
            Heading {
                azimuth_deg: degrees(azimuth),
                elevation_deg: degrees(elevation),
                error_deg: degrees(heading.error_rad),
            }
        });
        let threat = cue.threat.map(|threat| Threat {
            azimuth_deg: degrees(threat.azimuth_rad),
            elevation_deg: degrees(threat.elevation_rad),
            time_s: round(threat.time_s, 3),
            sectors: threat.sectors,
            alarm: threat.alarm,
        });
        Self {
            frame: number,
            time_s: round(cue.time_s, 9),
            valid: cue.invalid.is_none(),
            invalid_kind: cue.invalid.map(|reason| KINDS[kind(&reason)]),
            invalid: cue.invalid.map(|reason| reason.to_string()),
            heading,
            threat,
            sectors: SectorLists::new(cue.sectors, cue.invalid.is_none(), detail),
            timing: Timing { age_ms: round(age_ms, 3), latency_ms: round(latency_ms, 3), dropped },
        }
    }
}

impl SectorLists {
    /// Of an invalid cue no time is given, so that none can be taken for one.
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
            detail: detail.then(|| Detail {
                ttc_early_s: times(0),
                ttc_late_s: times(2),
                nearness_rate_hz: rates(|sector| sector.nearness_rate_hz[1]),
                divergence_hz: rates(|sector| sector.divergence_hz),
                confidence: all.sectors.iter().map(|sector| round(sector.confidence, 2)).collect(),
            }),
        }
    }
}

/// What is said of a frame to somebody who reads along.
pub(super) fn text(number: u64, cue: &Cue<'_>) -> String {
    let state = match (&cue.invalid, &cue.threat) {
        (Some(reason), _) => format!("invalid: {reason}"),
        (None, None) => "clear".to_owned(),
        (None, Some(threat)) => format!(
            "{:<6} in {:.2} s at azimuth {:+.1}°, elevation {:+.1}°, {} sectors",
            if threat.alarm { "ALARM" } else { "threat" },
            threat.time_s,
            threat.azimuth_rad.to_degrees(),
            threat.elevation_rad.to_degrees(),
            threat.sectors,
        ),
    };
    format!("{number:6} {:10.3} s  {state}", cue.time_s)
}

/// The kinds of reasons, in the order of [`kind`].
pub(super) const KINDS: [&str; 7] = ["first", "interval", "gyro", "coverage", "lost", "frozen", "turn"];

/// Which kind of reason it is.
pub(super) fn kind(reason: &Invalid) -> usize {
    match reason {
        Invalid::First => 0,
        Invalid::Interval { .. } => 1,
        Invalid::Gyro(_) => 2,
        Invalid::Coverage { .. } => 3,
        Invalid::Lost => 4,
        Invalid::Frozen => 5,
        Invalid::Turn { .. } => 6,
    }
}

fn degrees(radians: f64) -> f64 {
    round(radians.to_degrees(), 2)
}

/// A number with so many decimals, so that lines stay short.
fn round(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    let rounded = (value * scale).round() / scale;
    // −0 would be written as such.
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_minus_zero() {
        assert_eq!(round(1.234_567, 3), 1.235);
        assert!(round(-1e-9, 3).is_sign_positive());
        assert!(round(f64::NAN, 3).is_nan());
    }
}
