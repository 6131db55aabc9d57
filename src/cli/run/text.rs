//! A frame's cue as a line of text.

use crate::pipeline::Cue;

/// The line for frame `number`.
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
