use std::path::Path;

use super::PairFiles;
use super::listing::{files, name};
use crate::error::Result;

/// Folders of frames, the first one that is there: colour of 2015, gray of 2012, colour of 2012.
const FRAMES: [&str; 3] = ["image_2", "image_0", "colored_0"];
const FIRST: &str = "_10.png";

/// The pairs that `flow_occ` states, or else `flow_noc`.
pub(super) fn pairs(folder: &Path) -> Result<Vec<PairFiles>> {
    let inner = folder.join("training");
    let folder = if inner.is_dir() { &inner } else { folder };
    let Some(frames) = FRAMES.iter().map(|name| folder.join(name)).find(|path| path.is_dir()) else {
        return Ok(Vec::new());
    };
    let (all, visible) = (folder.join("flow_occ"), folder.join("flow_noc"));
    let mut pairs = Vec::new();
    for flow in files(if all.is_dir() { &all } else { &visible }, &["png"])? {
        let file = name(&flow);
        let Some(number) = file.strip_suffix(FIRST).map(str::to_owned) else { continue };
        let seen = visible.join(&file);
        pairs.push(PairFiles {
            number: number.parse().ok(),
            frames: [frames.join(&file), frames.join(format!("{number}_11.png"))],
            visible_flow: (all.is_dir() && seen.is_file()).then_some(seen),
            flow,
            name: number,
            ..PairFiles::default()
        });
    }
    Ok(pairs)
}
