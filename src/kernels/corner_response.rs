//! The corner response of each pixel, of the structure tensor summed over a block: its smaller eigenvalue (Shi and
//! Tomasi, Good features to track, CVPR 1994), or `det − k trace²` (Harris and Stephens, A combined corner and edge
//! detector, Alvey Vision Conference 1988). OpenCV's `cornerMinEigenVal` and `cornerHarris`.

use super::parallel_rows::{Split, bands, dimensions, reflect_101, repeat_last};
use super::test_inputs::{Fill, Random, cases as each_fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the block, and the kind of response.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Columns of the block, 1 to 64.
        block: u32,
        /// 0 for the smaller eigenvalue, 1 for Harris' response.
        harris: u32,
        /// The weight of the squared trace in Harris' response.
        k: f32,
    }
}

kernel!(
    "corner_response" + ["image"],
    reference(Params; columns) -> (response),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 0.0, of_largest: 0.0,
        reason: "the roundings of its own products, differences and root; what is smaller than 10⁻³⁰ a GPU may flush to zero",
    },
    rounding: rounding,
);

fn reference(p: &Params, columns: &[f32], response: &mut [f32]) {
    each_tensor(p, columns, response, #[inline(always)] |[xx, xy, yy]| match p.harris {
        1 => xx * yy - xy * xy - p.k * (xx + yy) * (xx + yy),
        _ => {
            let (a, c) = (0.5 * xx, 0.5 * yy);
            (a + c) - ((a - c) * (a - c) + xy * xy).sqrt()
        }
    });
}

/// Calls `f` with the tensor of each pixel, summed over the block.
fn each_tensor(p: &Params, columns: &[f32], result: &mut [f32], f: impl Fn([f32; 3]) -> f32 + Sync) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (block, half) = (p.block as usize, (p.block / 2) as usize);
    let extended = width + block;
    let split = Split { scratch: 3 * (extended + width), dearer: 4, ..Split::rows_of(stride) };
    bands(result, &mut [], split, #[inline(always)] |band| {
        let (mirrored, sums) = band.scratch.split_at_mut(3 * extended);
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let rows = &columns[3 * (band.y0 + i) * stride..][..3 * stride];
            for c in 0..3 {
                let (row, mirrored) = (&rows[c * stride..], &mut mirrored[c * extended..][..extended]);
                for (x, value) in mirrored.iter_mut().enumerate() {
                    *value = row[reflect_101(x as isize - half as isize, width)];
                }
                let sums = &mut sums[c * width..][..width];
                sums.fill(0.0);
                for k in 0..block {
                    sums.iter_mut().zip(&mirrored[k..]).for_each(|(sum, value)| *sum += value);
                }
            }
            for x in 0..width {
                out[x] = f([sums[x], sums[width + x], sums[2 * width + x]]);
            }
            repeat_last(out, width);
        }
    });
}

/// The sums are added in the same order on both sides. The smaller eigenvalue `a + c − √q`, with `q = (a − c)² + b²`,
/// has some ten roundings of `a + c + |b|`: the root halves the relative error of q, which has four, and WGSL allows it
/// 2.5 units in the last place. Harris' response has as many of its terms.
fn rounding(p: &Params, columns: &[f32], bound: &mut [f32]) {
    each_tensor(p, columns, bound, |[xx, xy, yy]| {
        let trace = xx.abs() + yy.abs();
        match p.harris {
            1 => 8.0 * f32::EPSILON * ((xx * yy).abs() + xy * xy + p.k.abs() * trace * trace),
            _ => 8.0 * f32::EPSILON * (trace + xy.abs()),
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let all = [(1, 0), (3, 0), (6, 1)].map(|(block, harris)| {
        let params = Params { width: size.width, height: size.height, block, harris, k: 0.04 };
        let cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[size.stride()], size, |fill| {
            let mut random = Random::new(5);
            let mut columns = planes(size, 3, fill, [0.0, 1.0], 3);
            // The mixed product of a tensor lies between both signs of the squares' geometric mean.
            for rows in columns.chunks_exact_mut(3 * size.stride()) {
                for x in 0..size.width as usize {
                    let [xx, yy] = [rows[x], rows[2 * size.stride() + x]];
                    rows[size.stride() + x] = (2.0 * random.next() - 1.0) * (xx * yy).sqrt();
                }
                repeat_last(&mut rows[size.stride()..2 * size.stride()], size.width as usize);
            }
            vec![columns]
        });
        cases.into_iter().map(move |case| Case { name: format!("{}, block {block}", case.name), ..case })
    });
    all.into_iter().flatten().collect()
}
