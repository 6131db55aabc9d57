//! Where the pictures come from: brightness, the lens taken out, and the frame before as the turned camera would see it.

use super::config::{Derotation, Sphere};
use super::motion::MOTION_LEN;
use super::plan::Eye;
use crate::camera::Lens;
use crate::flow::gray_step;
use crate::frame::PixelFormat;
use crate::kernels::{lens_map, remap};
use crate::plan::{BufId, Bufs, PortKind, Shape, Step, pack};

/// Where the pictures come from, in the ideal camera's geometry.
pub(super) struct Front<'a> {
    eye: Eye<'a>,
    pub(super) frame: BufId,
    /// The frames' brightness, by parity; one buffer where the frame before is not looked at again.
    raw: [BufId; 2],
    /// The picture that is expanded.
    gray: BufId,
    /// How far the ideal camera's pixels can be trusted.
    pub(super) certainty: BufId,
    /// Where each pixel is read; none where the raw frame is the ideal picture.
    pub(super) map: Option<Map>,
    /// The same for the frame before, as the turned camera would have seen it.
    pub(super) turned: Option<Map>,
    mask: Option<BufId>,
    /// No turn.
    pub(super) still: BufId,
    lens: lens_map::Params,
}

/// A resampling.
#[derive(Clone, Copy)]
pub(super) struct Map {
    places: BufId,
    pub(super) certainty: BufId,
}

impl<'a> Front<'a> {
    pub(super) fn new(bufs: &mut Bufs, eye: Eye<'a>, view: &Sphere, format: PixelFormat) -> Self {
        let (raw, ideal) = (eye.raw.size, eye.ideal.size);
        let lens = lens_map::Params::new(eye.ideal, eye.raw).with_margin(view.margin_px as f32);
        let turns = eye.gyro && view.derotation == Derotation::Before;
        let plain = eye.raw == eye.ideal && eye.raw.lens == Lens::NONE && eye.mask.is_none();
        let map = |bufs: &mut Bufs, name: &str| Map {
            places: bufs.computed(format!("{name} map"), Shape::planar(ideal, 2)),
            certainty: bufs.computed(format!("{name} certainty"), Shape::planar(ideal, 1)),
        };
        let first = bufs.computed("brightness", Shape::planar(raw, 1));
        let second =
            if turns { bufs.computed("brightness of odd frames", Shape::planar(raw, 1)) } else { first };
        let turned = turns.then(|| map(bufs, "turned"));
        let undistort = (!plain).then(|| map(bufs, "undistortion"));
        Self {
            eye,
            frame: bufs.input("frame", PortKind::Frame { size: raw, format }.len()),
            raw: [first, second],
            gray: if plain && !turns { first } else { bufs.computed("gray", Shape::planar(ideal, 1)) },
            certainty: match undistort {
                Some(map) => map.certainty,
                None => bufs.constant("equal certainty", vec![1.0; Shape::planar(ideal, 1).len()]),
            },
            mask: (undistort.is_some() || turns).then(|| {
                let mask = eye.mask.map_or_else(|| vec![1.0; Shape::planar(raw, 1).len()], pack::share);
                bufs.constant("mask", mask)
            }),
            map: undistort,
            turned,
            still: bufs.constant("no turn", vec![0.0; MOTION_LEN]),
            lens: match eye.mask {
                Some(_) => lens,
                None => lens.without_mask(),
            },
        }
    }

    /// What is computed once.
    pub(super) fn setup(&self) -> Vec<Step> {
        self.map.iter().flat_map(|map| self.make(*map, self.still, "undistortion")).collect()
    }

    pub(super) fn make(&self, map: Map, motion: BufId, label: &str) -> Option<Step> {
        let ideal = self.eye.ideal.size;
        Some(Step::new(
            &lens_map::KERNEL,
            label,
            self.lens,
            &[motion, self.mask?],
            &[(map.places, Shape::planar(ideal, 2)), (map.certainty, Shape::planar(ideal, 1))],
        ))
    }

    pub(super) fn brightness(&self, parity: usize, format: PixelFormat) -> Step {
        gray_step(self.eye.raw.size, format, self.frame, self.raw[parity])
    }

    /// The picture of a frame through a map; the frame itself where there is none.
    pub(super) fn picture(
        &self,
        steps: &mut Vec<Step>,
        parity: usize,
        map: Option<Map>,
        label: &str,
    ) -> BufId {
        let Some(map) = map else { return self.raw[parity] };
        let (raw, ideal) = (self.eye.raw.size, self.eye.ideal.size);
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
