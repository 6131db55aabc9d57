use std::path::Path;

use super::PairFiles;
use super::listing::{files, stem};
use crate::error::Result;

/// The pairs that `flow/` states.
pub(super) fn pairs(folder: &Path) -> Result<Vec<PairFiles>> {
    let frames = folder.join("frames");
    if !frames.is_dir() {
        return Ok(Vec::new());
    }
    let mut pairs = Vec::new();
    for flow in files(&folder.join("flow"), &["flo"])? {
        let name = stem(&flow);
        let Ok(number) = name.parse::<u64>() else { continue };
        let next = format!("{:0width$}", number + 1, width = name.len());
        let depth = folder.join("depth").join(format!("{name}.npy"));
        pairs.push(PairFiles {
            frames: [&name, &next].map(|frame| frames.join(format!("{frame}.png"))),
            number: Some(number),
            depth: depth.is_file().then_some(depth),
            name,
            flow,
            ..PairFiles::default()
        });
    }
    Ok(pairs)
}
