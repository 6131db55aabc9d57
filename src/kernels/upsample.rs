//! Samples a coarser level's flow, or another image of some channels, bilinearly at this level's pixels and scales it.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use super::tables;
use super::test_inputs::{Fill, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the two levels.
    struct Params {
        /// Pixels in a row of the result.
        width: u32,
        /// Rows of the result.
        height: u32,
        /// Pixels in a row of the coarser level.
        in_width: u32,
        /// Rows of the coarser level.
        in_height: u32,
        /// The factor of the values: that of displacements is the ratio of the levels' sizes.
        scale: f32,
        /// Channels, 1 to 8: 2 for a flow.
        channels: u32,
    }
}

kernel!(
    "upsample" + [],
    reference(Params; coarse, place_x, place_y) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 40.0 * 16.0 * f32::EPSILON,
        relative: 8.0 * f32::EPSILON, of_largest: 0.0,
        reason: "two linear mixes of displacements up to 40 px of either sign, fused or not",
    },
);

fn reference(p: &Params, coarse: &[f32], place_x: &[f32], place_y: &[f32], flow: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (in_width, in_height, in_stride) = dimensions(p.in_width, p.in_height);
    let channels = p.channels as usize;
    let split = Split { scratch: in_stride, ..Split::rows_of(channels * stride) };
    bands(flow, &mut [], split, #[inline(always)] |band| {
        for (i, rows) in band.out.chunks_exact_mut(channels * stride).enumerate() {
            let y = band.y0 + i;
            let (above, fraction) = (place_y[2 * y] as usize, place_y[2 * y + 1]);
            let below = (above + 1).min(in_height - 1);
            for (channel, out) in rows.chunks_exact_mut(stride).enumerate() {
                let above = &coarse[(channels * above + channel) * in_stride..][..in_stride];
                let below = &coarse[(channels * below + channel) * in_stride..][..in_stride];
                for ((mixed, above), below) in band.scratch.iter_mut().zip(above).zip(below) {
                    *mixed = mix(*above, *below, fraction);
                }
                for (out, place) in out[..width].iter_mut().zip(place_x.as_chunks::<2>().0) {
                    let left = place[0] as usize;
                    let right = (left + 1).min(in_width - 1);
                    *out = p.scale * mix(band.scratch[left], band.scratch[right], place[1]);
                }
                repeat_last(out, width);
            }
        }
    });
}

#[inline(always)]
fn mix(a: f32, b: f32, share: f32) -> f32 {
    a * (1.0 - share) + b * share
}

fn cases(size: Size) -> Vec<Case> {
    let coarse = Size::new(size.width.div_ceil(2), size.height.div_ceil(2));
    let all = [(2, 2.0), (4, 1.0)].map(|(channels, scale)| {
        let params = Params {
            width: size.width,
            height: size.height,
            in_width: coarse.width,
            in_height: coarse.height,
            scale,
            channels,
        };
        let channels = channels as usize;
        let cases = each_fill(Fill::ALL, bytemuck::bytes_of(&params), &[channels * size.stride()], size, |fill| {
            vec![
                planes(coarse, channels, fill, [-40.0, 40.0], 5),
                tables::place(coarse.width, size.width),
                tables::place(coarse.height, size.height),
            ]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, {channels} channels", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
