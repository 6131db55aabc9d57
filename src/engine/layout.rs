//! How pictures lie in a plan's buffers, and how they get there and back without a copy in between.

use std::iter::repeat_n;

use super::Extras;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Frame, PixelFormat, Size};
use crate::kernels::luma;
use crate::plan::{Plan, Shape};
use crate::sphere::MOTION_LEN;

/// Lengths of what goes into and comes out of a plan, in values of four bytes.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) size: Size,
    /// Size of the flow and the confidence.
    pub(super) flow_size: Size,
    pub(super) format: PixelFormat,
    /// One row of the frame.
    pub(super) row: usize,
    pub(super) frame: usize,
    /// 0 where the plan takes none.
    pub(super) certainty: usize,
    /// 0 where the plan takes none.
    pub(super) initial: usize,
    /// 0 where the plan takes none.
    pub(super) motion: usize,
    /// 0 where it is not read.
    pub(super) flow: usize,
    /// 0 where it is not read.
    pub(super) confidence: usize,
    /// All the plan's fields together.
    pub(super) fields: usize,
}

impl Layout {
    pub(super) fn new(plan: &Plan, config: &super::Config) -> Self {
        let size = plan.size;
        let when = |wanted: bool, shape: Shape| if wanted { shape.len() } else { 0 };
        let plane = Shape::planar(plan.flow_size, 1);
        let field = Shape::planar(plan.flow_size, 2);
        Self {
            size,
            flow_size: plan.flow_size,
            format: config.format,
            row: luma::row_words(size, config.format),
            frame: plan.buf(plan.frame).len,
            certainty: when(plan.certainty.is_some(), Shape::planar(size, 1)),
            initial: when(plan.initial_flow, field),
            motion: plan.motion.map_or(0, |_| MOTION_LEN),
            flow: when(config.read_flow, field),
            confidence: when(config.read_confidence && plan.confidence.is_some(), plane),
            fields: plan.fields.iter().map(|(_, shape)| shape.len()).sum(),
        }
    }

    /// Values that come with a frame.
    pub(super) fn upload(&self) -> usize {
        self.frame + self.certainty + self.initial + self.motion
    }

    /// Values that are read of a pair.
    pub(super) fn readback(&self) -> usize {
        self.flow + self.confidence + self.fields
    }

    /// Checks that a frame and what comes with it fit.
    pub(super) fn check(&self, frame: &Frame<'_>, extras: &Extras<'_>) -> Result<()> {
        let same_size = |what: &str, found: Size| {
            if found == self.size {
                return Ok(());
            }
            Err(Error::SizeMismatch { what: what.to_owned(), found, expected: self.size })
        };
        same_size("frame", frame.size())?;
        if frame.format() != self.format {
            return Err(Error::PixelFormat { found: frame.format(), expected: self.format });
        }
        if let Some(certainty) = extras.certainty {
            if self.certainty == 0 {
                return Err(Error::parameter("certainty", "given", "none, as flow.certainty is off"));
            }
            certainty.validate()?;
            same_size("certainty", certainty.size)?;
        }
        if extras.motion.is_some() && self.motion == 0 {
            return Err(Error::parameter("motion", "given", "none, as nothing of the plan asks for it"));
        }
        if let Some(flow) = extras.initial_flow {
            if self.initial == 0 {
                let expected = "none, as flow.initial_flow and warm_start are off";
                return Err(Error::parameter("initial_flow", "given", expected));
            }
            flow.validate()?;
            same_size("initial flow", flow.size)?;
        }
        Ok(())
    }
}

/// A certainty's values as a plan wants them: held within 0 and 1, each row's surplus repeating its last pixel.
pub(super) fn certainty(values: &[f32], size: Size) -> impl Iterator<Item = f32> {
    // Written so that NaN becomes 0.
    let held = |value: &f32| if *value > 0.0 { value.min(1.0) } else { 0.0 };
    values.chunks_exact(size.width as usize).flat_map(move |row| padded(row, size, held))
}

/// A flow's values as a plan wants them: row by row u and then v, unknown ones zero.
pub(super) fn flow(field: &FlowField) -> impl Iterator<Item = f32> {
    let size = field.size;
    field.data.chunks_exact(size.width as usize).flat_map(move |row| {
        [0, 1].into_iter().flat_map(move |c| {
            padded(row, size, move |&uv: &[f32; 2]| if FlowField::is_known(uv) { uv[c] } else { 0.0 })
        })
    })
}

fn padded<T>(row: &[T], size: Size, value: impl Fn(&T) -> f32 + Copy) -> impl Iterator<Item = f32> {
    let surplus = size.stride() - row.len();
    row.iter().map(value).chain(row.last().into_iter().flat_map(move |last| repeat_n(value(last), surplus)))
}

/// A plan's flow as pairs, without the surplus.
pub(super) fn unpack_flow(values: &[f32], size: Size, out: &mut [[f32; 2]]) {
    let (width, stride) = (size.width as usize, size.stride());
    for (rows, out) in values.chunks_exact(2 * stride).zip(out.chunks_exact_mut(width)) {
        let (u, v) = rows.split_at(stride);
        for ((out, &u), &v) in out.iter_mut().zip(u).zip(v) {
            *out = [u, v];
        }
    }
}

/// A plan's plane without the surplus.
pub(super) fn unpack_plane(values: &[f32], size: Size, out: &mut [f32]) {
    let width = size.width as usize;
    for (row, out) in values.chunks_exact(size.stride()).zip(out.chunks_exact_mut(width)) {
        out.copy_from_slice(&row[..width]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_certainty_is_held_within_0_and_1() {
        let values = [-1.0, f32::NAN, 0.25, f32::INFINITY, 2.0, -0.0];
        let packed: Vec<f32> = certainty(&values, Size::new(3, 2)).collect();
        assert_eq!(packed, [0.0, 0.0, 0.25, 0.25, 1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_flow_comes_back_as_it_was() {
        for width in 1..6 {
            let size = Size::new(width, 2);
            let data: Vec<[f32; 2]> = (0..2 * width).map(|i| [i as f32, -(i as f32)]).collect();
            let field = FlowField { size, data };
            let packed: Vec<f32> = flow(&field).collect();
            assert_eq!(packed.len(), Shape::planar(size, 2).len());
            assert_eq!(packed[size.stride() - 1], width as f32 - 1.0);
            let mut back = vec![[9.0; 2]; field.data.len()];
            unpack_flow(&packed, size, &mut back);
            assert_eq!(back, field.data);
        }
    }

    #[test]
    fn an_unknown_flow_is_none() {
        let size = Size::new(2, 1);
        let field = FlowField { size, data: vec![[crate::frame::UNKNOWN_FLOW; 2], [f32::NAN, 1.0]] };
        assert_eq!(flow(&field).collect::<Vec<f32>>(), [0.0; 8]);
    }
}
