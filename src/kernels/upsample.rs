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
    let places = place_x.as_chunks::<2>().0;
    let doubles = doubles(places, width, in_width);
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
                let mixed = &band.scratch[..in_width];
                let at = |place: &[f32; 2]| {
                    let left = place[0] as usize;
                    let right = (left + 1).min(in_width - 1);
                    p.scale * mix(mixed[left], mixed[right], place[1])
                };
                if doubles {
                    // Neighbouring columns need no table, so that they are computed side by side.
                    for (out, ends) in out[1..].as_chunks_mut::<2>().0.iter_mut().zip(mixed.windows(2)) {
                        *out = [0.25, 0.75].map(|fraction| p.scale * mix(ends[0], ends[1], fraction));
                    }
                    (out[0], out[width - 1]) = (at(&places[0]), at(&places[width - 1]));
                } else {
                    out.iter_mut().zip(places).for_each(|(out, place)| *out = at(place));
                }
                repeat_last(out, width);
            }
        }
    });
}

/// Whether each column lies a quarter of a pixel beside one of half as many columns.
fn doubles(places: &[[f32; 2]], width: usize, in_width: usize) -> bool {
    let inner = (1..width.saturating_sub(1)).map(|x| [((x - 1) / 2) as f32, if x % 2 == 1 { 0.25 } else { 0.75 }]);
    width == 2 * in_width && in_width > 1 && inner.zip(&places[1..]).all(|(expected, found)| expected == *found)
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
