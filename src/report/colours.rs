//! The colours of overlays and charts.

pub(super) const BACKGROUND: [u8; 3] = [22, 26, 33];
pub(super) const FRAME: [u8; 3] = [11, 13, 17];
pub(super) const TEXT: [u8; 3] = [236, 240, 246];
pub(super) const DIM: [u8; 3] = [150, 160, 176];
/// The chosen arc.
pub(super) const ARC: [u8; 3] = [70, 235, 200];
pub(super) const GOAL: [u8; 3] = [170, 120, 255];
/// Errors and invalid cues.
pub(super) const WRONG: [u8; 3] = [255, 92, 92];
/// A time to contact above the last of [`TIMES`].
pub(super) const LATER: [u8; 3] = [84, 94, 112];

/// Times to contact in seconds, each with the colour of shorter ones.
pub(super) const TIMES: [(f64, [u8; 3]); 4] =
    [(1.0, [255, 30, 30]), (2.0, [255, 140, 0]), (4.0, [255, 230, 0]), (8.0, [60, 220, 60])];

/// The colour of a time to contact.
pub(super) fn time_colour(time_s: f64) -> [u8; 3] {
    TIMES.iter().find(|(limit, _)| time_s < *limit).map_or(LATER, |(_, colour)| *colour)
}
