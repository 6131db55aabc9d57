//! The share of frames without a valid cue, with the reason.

use std::collections::BTreeMap;

/// The share of frames without a valid cue, as text. `share` is 0 to 1; above one half the most frequent reason is
/// added.
pub(super) fn text<'a>(share: f64, reasons: impl Iterator<Item = &'a str>) -> String {
    let mut alike: BTreeMap<String, (usize, &str)> = BTreeMap::new();
    for reason in reasons {
        // Reasons that differ only in their numbers are counted together.
        let kind = reason.replace(|c: char| c.is_ascii_digit(), "");
        alike.entry(kind).or_insert((0, reason)).0 += 1;
    }
    let most = alike.into_values().max_by_key(|(count, _)| *count).filter(|_| share > 0.5);
    let why = most.map_or(String::new(), |(_, reason)| format!(", mostly because {reason}"));
    format!("{:.1} % of the frames without a valid one{why}", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reason_is_told_where_most_frames_have_no_cue() {
        let reasons =
            ["the previous frame was lost", "0.001 of the view is trusted", "0.000 of the view is trusted"];
        assert_eq!(text(0.03, reasons.into_iter()), "3.0 % of the frames without a valid one");
        assert_eq!(
            text(1.0, reasons.into_iter()),
            "100.0 % of the frames without a valid one, mostly because 0.001 of the view is trusted"
        );
        assert_eq!(text(0.0, [].into_iter()), "0.0 % of the frames without a valid one");
    }
}
