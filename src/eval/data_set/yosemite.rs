use std::path::Path;

use super::PairFiles;
use super::listing::{files, stem};
use crate::error::Result;

const IMAGES: [&str; 3] = ["png", "pgm", "ppm"];

/// For each truth the pair from its frame to the next one and, if the previous frame has no truth of its own, that from the
/// previous frame to it, since the sequence moves evenly.
pub(super) fn pairs(folder: &Path) -> Result<Vec<PairFiles>> {
    let images = files(folder, &IMAGES)?;
    let frame = |prefix: &str, number: u64| {
        let is_it = |path: &&std::path::PathBuf| {
            let stem = stem(path);
            let digits = stem.strip_prefix(prefix).and_then(|rest| rest.strip_prefix("yos"));
            digits.and_then(|digits| digits.parse::<u64>().ok()) == Some(number)
        };
        images.iter().find(is_it).cloned()
    };
    let mut pairs = Vec::new();
    let flows = files(folder, &["flo"])?;
    let has_truth = |prefix: &str, number: u64| {
        let parsed = |path: &std::path::PathBuf| {
            let stem = stem(path);
            let digits = stem.strip_prefix(prefix).and_then(|rest| rest.strip_prefix("flow"));
            digits.and_then(|digits| digits.parse::<u64>().ok())
        };
        flows.iter().any(|path| parsed(path) == Some(number))
    };
    for flow in &flows {
        let name = stem(flow);
        let Some((prefix, digits)) = name.split_once("flow") else { continue };
        let Ok(number) = digits.parse::<u64>() else { continue };
        let mask = images.iter().find(|path| stem(path) == format!("{prefix}mask_land")).cloned();
        let Some(own) = frame(prefix, number) else { continue };
        let pair = |first: u64, frames: [std::path::PathBuf; 2]| PairFiles {
            name: format!("{first}-{}", first + 1),
            number: Some(first),
            frames,
            flow: flow.clone(),
            mask: mask.clone(),
            ..PairFiles::default()
        };
        let missing = folder.join(format!("{prefix}yos{:02}.png", number + 1));
        let next = frame(prefix, number + 1);
        let before = number.checked_sub(1).filter(|before| !has_truth(prefix, *before));
        let previous = before.and_then(|before| frame(prefix, before));
        if next.is_some() || previous.is_none() {
            pairs.push(pair(number, [own.clone(), next.unwrap_or(missing)]));
        }
        pairs.extend(previous.map(|previous| pair(number - 1, [previous, own])));
    }
    Ok(pairs)
}
