use std::path::Path;

use super::PairFiles;
use super::listing::files;
use crate::error::Result;

const IMAGES: [&str; 6] = ["png", "jpg", "jpeg", "pgm", "ppm", "pnm"];

/// The pair of a folder with two images, the first one by name before the second, and one flow field. With `frame10`,
/// `frame11` and `flow10.flo`, as in Middlebury's folders, other files do not matter.
pub(super) fn pairs(folder: &Path) -> Result<Vec<PairFiles>> {
    let name = super::name(folder);
    let known = ["frame10.png", "frame11.png"].map(|file| folder.join(file));
    let flow = folder.join("flow10.flo");
    if flow.is_file() && known.iter().any(|path| path.is_file()) {
        return Ok(vec![PairFiles { name, frames: known, flow, ..PairFiles::default() }]);
    }
    let (images, mut flows) = (files(folder, &IMAGES)?, files(folder, &["flo"])?);
    let Ok(frames) = <[_; 2]>::try_from(images) else { return Ok(Vec::new()) };
    match (flows.pop(), flows.is_empty()) {
        (Some(flow), true) => Ok(vec![PairFiles { name, frames, flow, ..PairFiles::default() }]),
        _ => Ok(Vec::new()),
    }
}
