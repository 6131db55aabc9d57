//! Data sets of pairs with ground truth, found by the conventions of their folders.
//!
//! | kind | folders |
//! |---|---|
//! | `middlebury` | `NAME/frame10.png`, `frame11.png`, `flow10.flo`; or `other-data/NAME/` and `other-gt-flow/NAME/` |
//! | `kitti` | `[training/]image_2` (or `image_0`, `colored_0`) `/NNNNNN_10.png`, `_11.png`; `flow_occ`, `flow_noc` |
//! | `sintel` | `[training/]clean`, `final` `/SCENE/frame_NNNN.png`; `flow/SCENE/frame_NNNN.flo`; `occlusions`, `invalid` |
//! | `yosemite` | `yosNN.png`, `flowNN.flo`, `mask_land.png`, with or without `derived_` before them |
//! | `simulated` | what `viewsphere simulate` writes: `frames/`, `flow/`, `depth/` |
//! | `pair` | two images and one `.flo` |
//!
//! The truth states the pairs: a frame that a truth needs and that is missing is an error of that pair.

mod kind;
mod kitti;
mod listing;
mod load;
mod middlebury;
mod pair;
mod simulated;
mod single;
mod sintel;
mod yosemite;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

pub use kind::Kind;
pub use load::LoadedPair;
pub use pair::PairFiles;

use crate::error::{Error, Result};

/// How many folders below the given one are searched.
const DEPTH: u32 = 3;

/// A data set: its name and pairs.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSet {
    /// The name: the folder's.
    pub name: String,
    /// The convention by which it was found.
    pub kind: Kind,
    /// The pairs, in order of their names.
    pub pairs: Vec<PairFiles>,
}

/// Finds the data sets in a folder: the folder itself, or folders inside it. With a `kind` only those of that kind.
///
/// # Errors
/// [`Error::Io`] for a folder that cannot be read; [`Error::Format`] if there is no data set, and for two pairs of one name.
pub fn find(folder: &Path, kind: Option<Kind>) -> Result<Vec<DataSet>> {
    let found = search(folder, kind, DEPTH)?;
    if found.is_empty() {
        let names =
            kind.map_or_else(|| Kind::ALL.map(Kind::layout).join("; "), |kind| kind.layout().to_owned());
        return Err(Error::format(folder, "data set", "none", names));
    }
    Ok(found)
}

fn search(folder: &Path, kind: Option<Kind>, depth: u32) -> Result<Vec<DataSet>> {
    for known in Kind::ALL.into_iter().filter(|known| kind.is_none_or(|kind| kind == *known)) {
        let pairs = known.pairs(folder)?;
        if !pairs.is_empty() {
            let mut names = BTreeSet::new();
            if let Some(twice) = pairs.iter().find(|pair| !names.insert(&pair.name)) {
                let found = format!("two pairs named {}", twice.name);
                return Err(Error::format(folder, "data set", found, "pairs with different names"));
            }
            return Ok(vec![DataSet { name: name(folder), kind: known, pairs }]);
        }
    }
    let mut found = Vec::new();
    if depth > 0 {
        for inner in listing::folders(folder)? {
            found.extend(search(&inner, kind, depth - 1)?);
        }
    }
    Ok(found)
}

/// The name of a set in this folder; that of the folder above for parts such as `training`.
fn name(folder: &Path) -> String {
    let whole: PathBuf = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let names = whole.iter().rev().map(|part| part.to_string_lossy().into_owned());
    names.into_iter().find(|name| name != "training").unwrap_or_else(|| "data".to_owned())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub(crate) mod tests {
    use std::fs;

    use super::*;

    /// Creates empty files.
    pub(crate) fn touch(folder: &Path, files: &[&str]) {
        for file in files {
            let path = folder.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
    }

    fn names(sets: &[DataSet]) -> Vec<String> {
        let pair = |set: &DataSet| {
            let pairs: Vec<&str> = set.pairs.iter().map(|pair| pair.name.as_str()).collect();
            format!("{} {}: {}", set.name, set.kind, pairs.join(" "))
        };
        sets.iter().map(pair).collect()
    }

    #[test]
    fn each_convention_is_found_alone_and_beside_others() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let sets: [(&str, &[&str], &str); 9] = [
            (
                "mb",
                &["Venus/frame10.png", "Venus/frame11.png", "Venus/flow10.flo", "No/frame10.png"],
                "middlebury: Venus",
            ),
            (
                "two",
                &[
                    "other-data/Venus/frame10.png",
                    "other-gt-flow/Venus/flow10.flo",
                    "other-data/Walking/frame10.png",
                ],
                "middlebury: Venus",
            ),
            (
                "k12",
                &["image_0/000003_10.png", "image_0/000003_11.png", "flow_noc/000003_10.png"],
                "kitti: 000003",
            ),
            (
                "k15",
                &[
                    "training/image_2/000001_10.png",
                    "training/flow_occ/000001_10.png",
                    "training/flow_noc/000001_10.png",
                ],
                "kitti: 000001",
            ),
            (
                "mpi",
                &[
                    "training/clean/alley/frame_0001.png",
                    "training/final/alley/frame_0001.png",
                    "training/flow/alley/frame_0001.flo",
                    "training/flow/alley/frame_0002.flo",
                ],
                "sintel: clean/alley/0001 clean/alley/0002 final/alley/0001 final/alley/0002",
            ),
            (
                "yos",
                &["derived_yos08.png", "derived_yos09.png", "derived_flow09.flo", "derived_mask_land.png"],
                "yosemite: 8-9",
            ),
            ("plain", &["yos09.png", "yos10.png", "flow09.flo"], "yosemite: 9-10"),
            (
                "sim",
                &["frames/000000.png", "flow/000000.flo", "flow/000001.flo", "poses.csv"],
                "simulated: 000000 000001",
            ),
            ("one", &["a.png", "b.jpg", "truth.flo"], "pair: one"),
        ];
        for (name, files, expected) in sets {
            let own = at.join(name);
            touch(&own, files);
            assert_eq!(names(&find(&own, None).unwrap()), [format!("{name} {expected}")]);
        }
        let mut expected: Vec<String> =
            sets.iter().map(|(name, _, expected)| format!("{name} {expected}")).collect();
        expected.sort();
        assert_eq!(names(&find(at, None).unwrap()), expected);
        let kitti = names(&find(at, Some(Kind::Kitti)).unwrap());
        assert_eq!(kitti, ["k12 kitti: 000003", "k15 kitti: 000001"]);
    }

    #[test]
    fn every_pair_of_a_sequence_has_one_truth() {
        let folder = tempfile::tempdir().unwrap();
        let frames = ["yos07.png", "yos08.png", "yos09.png", "yos10.png"];
        touch(folder.path(), &[&frames[..], &["flow08.flo", "flow09.flo"]].concat());
        let sets = find(folder.path(), None).unwrap();
        let mut pairs: Vec<(&str, String)> =
            sets[0].pairs.iter().map(|pair| (pair.name.as_str(), listing::name(&pair.flow))).collect();
        pairs.sort();
        let of = |name, flow: &str| (name, flow.to_owned());
        assert_eq!(pairs, [of("7-8", "flow08.flo"), of("8-9", "flow08.flo"), of("9-10", "flow09.flo")]);
        touch(folder.path(), &["derived_yos08.png", "derived_yos09.png", "derived_flow08.flo"]);
        let error = find(folder.path(), None).unwrap_err().to_string();
        assert!(error.contains("two pairs named 8-9"), "{error}");
    }

    #[test]
    fn a_folder_without_a_set_says_what_was_expected() {
        let folder = tempfile::tempdir().unwrap();
        touch(folder.path(), &["a.png", "b.png", "c.png", "x.flo", "sub/y.txt"]);
        let error = find(folder.path(), None).unwrap_err().to_string();
        assert!(error.contains("data set is none, expected ") && error.contains("frame10.png"), "{error}");
        let error = find(folder.path(), Some(Kind::Sintel)).unwrap_err().to_string();
        assert!(error.contains("frame_NNNN") && !error.contains("frame10.png"), "{error}");
        let error = find(&folder.path().join("missing"), None).unwrap_err();
        assert_eq!(error.code(), "io");
    }
}
