use std::path::Path;

use super::{PairFiles, kitti, middlebury, simulated, single, sintel, yosemite};
use crate::error::Result;
use crate::named::named;

/// A convention of a data set's folders. See [`data_set`](super).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// S. Baker et al., A Database and Evaluation Methodology for Optical Flow, IJCV 92 (2011).
    Middlebury,
    /// A. Geiger et al., Are we ready for autonomous driving?, CVPR 2012; M. Menze, A. Geiger, Object scene flow for
    /// autonomous vehicles, CVPR 2015.
    Kitti,
    /// D. Butler et al., A naturalistic open source movie for optical flow evaluation, ECCV 2012.
    Sintel,
    /// Lynn Quam's sequence; J. Barron et al., Performance of optical flow techniques, IJCV 12 (1994).
    Yosemite,
    /// What `viewsphere simulate` writes.
    Simulated,
    /// A folder of two images and their flow.
    Pair,
}

named!(Kind, "data set kind");

impl Kind {
    /// All kinds, in the order in which a folder is examined.
    pub const ALL: [Self; 6] =
        [Self::Middlebury, Self::Kitti, Self::Sintel, Self::Yosemite, Self::Simulated, Self::Pair];

    /// The name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Middlebury => "middlebury",
            Self::Kitti => "kitti",
            Self::Sintel => "sintel",
            Self::Yosemite => "yosemite",
            Self::Simulated => "simulated",
            Self::Pair => "pair",
        }
    }

    /// The files by which it is recognised, as text for people.
    pub(super) const fn layout(self) -> &'static str {
        match self {
            Self::Middlebury => "NAME/frame10.png and flow10.flo",
            Self::Kitti => "image_2 (image_0, colored_0)/NNNNNN_10.png and flow_occ or flow_noc",
            Self::Sintel => "clean or final/SCENE/frame_NNNN.png and flow/SCENE/frame_NNNN.flo",
            Self::Yosemite => "yosNN.png and flowNN.flo",
            Self::Simulated => "frames/NNNNNN.png and flow/NNNNNN.flo of viewsphere simulate",
            Self::Pair => "two images and one .flo",
        }
    }

    /// The pairs of a folder; none if it is no set of this kind.
    pub(super) fn pairs(self, folder: &Path) -> Result<Vec<PairFiles>> {
        match self {
            Self::Middlebury => middlebury::pairs(folder),
            Self::Kitti => kitti::pairs(folder),
            Self::Sintel => sintel::pairs(folder),
            Self::Yosemite => yosemite::pairs(folder),
            Self::Simulated => simulated::pairs(folder),
            Self::Pair => single::pairs(folder),
        }
    }
}
