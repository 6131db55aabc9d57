use std::path::Path;

use super::PairFiles;
use super::listing::{folders, name};
use crate::error::Result;

const FLOW: &str = "flow10.flo";

/// The pairs of folders with a `flow10.flo` each, or of the two folders in which the data set is distributed.
pub(super) fn pairs(folder: &Path) -> Result<Vec<PairFiles>> {
    let truths = folder.join("other-gt-flow");
    let frames = folder.join("other-data");
    let is_split = truths.is_dir() && frames.is_dir();
    let mut pairs = Vec::new();
    for truth in folders(if is_split { &truths } else { folder })? {
        let flow = truth.join(FLOW);
        if !flow.is_file() {
            continue;
        }
        let name = name(&truth);
        let beside = if is_split { frames.join(&name) } else { truth };
        let frames = ["frame10.png", "frame11.png"].map(|frame| beside.join(frame));
        pairs.push(PairFiles { name, frames, flow, ..PairFiles::default() });
    }
    Ok(pairs)
}
