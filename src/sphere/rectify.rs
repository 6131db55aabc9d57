//! The images that the flow is estimated on: brightness, undistorted, and the previous frame as the rotated camera
//! would see it.

use super::config::{Derotation, Sphere};
use super::motion::MOTION_LEN;
use super::plan::Cameras;
use crate::camera::Lens;
use crate::flow::gray_step;
use crate::frame::PixelFormat;
use crate::kernels::{remap, undistort_map};
use crate::plan::{BufId, Bufs, PortKind, Shape, Step, pack};

/// Builds the images in the ideal camera's geometry.
pub(super) struct Rectification<'a> {
    cameras: Cameras<'a>,
    pub(super) frame: BufId,
    /// The frames' brightness, by parity; one buffer where the previous frame is not read again.
    raw: [BufId; 2],
    /// The image that the estimator takes.
    gray: BufId,
    /// The certainty of the ideal camera's pixels.
    pub(super) certainty: BufId,
    /// The map from the ideal image to the raw frame; `None` where the raw frame is the ideal image.
    pub(super) map: Option<Map>,
    /// The same for the previous frame, as the rotated camera would have seen it.
    pub(super) turned: Option<Map>,
    mask: Option<BufId>,
    /// A constant: no rotation.
    pub(super) still: BufId,
    lens: undistort_map::Params,
}

/// A map of places in the raw frame, and the certainty there.
#[derive(Clone, Copy)]
pub(super) struct Map {
    places: BufId,
    pub(super) certainty: BufId,
}

impl<'a> Rectification<'a> {
    pub(super) fn new(bufs: &mut Bufs, cameras: Cameras<'a>, view: &Sphere, format: PixelFormat) -> Self {
        let (raw, ideal) = (cameras.raw.size, cameras.ideal.size);
        let lens = undistort_map::Params::new(cameras.ideal, cameras.raw).with_margin(view.margin_px as f32);
        let turns = cameras.gyro && view.derotation == Derotation::Before;
        let plain = cameras.raw == cameras.ideal && cameras.raw.lens == Lens::NONE && cameras.mask.is_none();
        let map = |bufs: &mut Bufs, name: &str| Map {
            places: bufs.computed(format!("{name} map"), Shape::planar(ideal, 2)),
            certainty: bufs.computed(format!("{name} certainty"), Shape::planar(ideal, 1)),
        };
        let first = bufs.computed("brightness", Shape::planar(raw, 1));
        let second =
            if turns { bufs.computed("brightness of odd frames", Shape::planar(raw, 1)) } else { first };
        let turned = turns.then(|| map(bufs, "rotation"));
        let undistort = (!plain).then(|| map(bufs, "undistortion"));
        Self {
            cameras,
            frame: bufs.input("frame", PortKind::Frame { size: raw, format }.len()),
            raw: [first, second],
            gray: if plain && !turns { first } else { bufs.computed("gray", Shape::planar(ideal, 1)) },
            certainty: match undistort {
                Some(map) => map.certainty,
                None => bufs.constant("full certainty", vec![1.0; Shape::planar(ideal, 1).len()]),
            },
            mask: (undistort.is_some() || turns).then(|| {
                let mask = cameras.mask.map_or_else(|| vec![1.0; Shape::planar(raw, 1).len()], pack::share);
                bufs.constant("mask", mask)
            }),
            map: undistort,
            turned,
            still: bufs.constant("no rotation", vec![0.0; MOTION_LEN]),
            lens: match cameras.mask {
                Some(_) => lens,
                None => lens.without_mask(),
            },
        }
    }

    /// The setup steps.
    pub(super) fn setup(&self) -> Vec<Step> {
        self.map.iter().flat_map(|map| self.make(*map, self.still, "undistortion")).collect()
    }

    pub(super) fn make(&self, map: Map, motion: BufId, label: &str) -> Option<Step> {
        let ideal = self.cameras.ideal.size;
        Some(Step::new(
            &undistort_map::KERNEL,
            label,
            self.lens,
            &[motion, self.mask?],
            &[(map.places, Shape::planar(ideal, 2)), (map.certainty, Shape::planar(ideal, 1))],
        ))
    }

    pub(super) fn brightness(&self, parity: usize, format: PixelFormat) -> Step {
        gray_step(self.cameras.raw.size, format, self.frame, self.raw[parity])
    }

    /// The image of a frame through a map; the frame itself without a map.
    pub(super) fn picture(
        &self,
        steps: &mut Vec<Step>,
        parity: usize,
        map: Option<Map>,
        label: &str,
    ) -> BufId {
        let Some(map) = map else { return self.raw[parity] };
        let (raw, ideal) = (self.cameras.raw.size, self.cameras.ideal.size);
        steps.push(Step::new(
            &remap::KERNEL,
            label,
            remap::Params {
                width: ideal.width,
                height: ideal.height,
                in_width: raw.width,
                in_height: raw.height,
            },
            &[self.raw[parity], map.places],
            &[(self.gray, Shape::planar(ideal, 1))],
        ));
        self.gray
    }
}
