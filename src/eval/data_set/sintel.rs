use std::path::Path;

use super::PairFiles;
use super::listing::{files, folders, name, stem};
use crate::error::Result;

const PASSES: [&str; 2] = ["clean", "final"];

/// The pairs that `flow` states, of each rendering pass that is there.
pub(super) fn pairs(folder: &Path) -> Result<Vec<PairFiles>> {
    let inner = folder.join("training");
    let folder = if inner.is_dir() { &inner } else { folder };
    let truths = folder.join("flow");
    let mut pairs = Vec::new();
    for pass in PASSES.into_iter().filter(|pass| truths.is_dir() && folder.join(pass).is_dir()) {
        for scene in folders(&truths)? {
            let scene_name = name(&scene);
            for flow in files(&scene, &["flo"])? {
                let first = stem(&flow);
                let Some(digits) = first.strip_prefix("frame_") else { continue };
                let Ok(number) = digits.parse::<u64>() else { continue };
                let next = format!("frame_{:0width$}", number + 1, width = digits.len());
                let frames = folder.join(pass).join(&scene_name);
                let beside = |part: &str| {
                    let path = folder.join(part).join(&scene_name).join(format!("{first}.png"));
                    path.is_file().then_some(path)
                };
                pairs.push(PairFiles {
                    name: format!("{pass}/{scene_name}/{digits}"),
                    number: Some(number),
                    frames: [first.clone(), next].map(|frame| frames.join(format!("{frame}.png"))),
                    occlusions: beside("occlusions"),
                    invalid: beside("invalid"),
                    flow,
                    ..PairFiles::default()
                });
            }
        }
    }
    Ok(pairs)
}
