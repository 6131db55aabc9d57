//! Shared by the kernels of windows around points: samples of an image in a window, and sums over them.

use super::parallel_rows::reflect_101;

/// The number of invocations that share a window's samples.
pub(super) const LANES: usize = 64;

/// A window's samples: columns, rows, and the share of a pixel by which they lie to the right of and below whole pixels.
#[derive(Clone, Copy)]
pub(super) struct Window {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) corner: [isize; 2],
    pub(super) part: [f32; 2],
}

impl Window {
    /// The window whose first sample lies at a place; `None` if it does not meet an image of this width and height.
    pub(super) fn at(
        place: [f32; 2],
        [columns, rows]: [u32; 2],
        [width, height]: [usize; 2],
    ) -> Option<Self> {
        let whole = place.map(f32::floor);
        let meets = |whole: f32, window: u32, side: usize| whole >= -(window as f32) && whole < side as f32;
        let inside = meets(whole[0], columns, width) && meets(whole[1], rows, height);
        inside.then(|| Self {
            columns: columns as usize,
            rows: rows as usize,
            corner: whole.map(|whole| whole as isize),
            part: [place[0] - whole[0], place[1] - whole[1]],
        })
    }

    /// Copies the pixels that the samples lie between, and `margin` more on every side, row by row. Returns the number
    /// of pixels in a row.
    #[inline(always)]
    pub(super) fn pixels(
        &self,
        image: &[f32],
        [width, height, stride]: [usize; 3],
        margin: usize,
        out: &mut [f32],
    ) -> usize {
        let side = self.columns + 1 + 2 * margin;
        let [x0, y0] = self.corner.map(|corner| corner - margin as isize);
        for (j, out) in out.chunks_exact_mut(side).take(self.rows + 1 + 2 * margin).enumerate() {
            let row = &image[reflect_101(y0 + j as isize, height) * stride..][..width];
            if x0 >= 0 && x0 as usize + side <= width {
                out.copy_from_slice(&row[x0 as usize..][..side]);
            } else {
                for (i, out) in out.iter_mut().enumerate() {
                    *out = row[reflect_101(x0 + i as isize, width)];
                }
            }
        }
        side
    }

    /// Samples pixels that [`Window::pixels`] has copied without a margin.
    #[inline(always)]
    pub(super) fn sample(&self, pixels: &[f32], out: &mut [f32]) {
        let (side, [x, y]) = (self.columns + 1, self.part);
        for (j, out) in out.chunks_exact_mut(self.columns).take(self.rows).enumerate() {
            let (above, below) = pixels[j * side..][..2 * side].split_at(side);
            let above = above.iter().zip(&above[1..]);
            let below = below.iter().zip(&below[1..]);
            for (out, ((a, b), (c, d))) in out.iter_mut().zip(above.zip(below)) {
                *out = (1.0 - y) * ((1.0 - x) * a + x * b) + y * ((1.0 - x) * c + x * d);
            }
        }
    }
}

/// Sums of values that `f` makes of equally long inputs, as the invocations of a workgroup add them: every 64th, then
/// eight sums of eight, then their sum.
#[inline(always)]
pub(super) fn lane_sums<const M: usize, const N: usize>(
    inputs: [&[f32]; M],
    f: impl Fn([f32; M]) -> [f32; N],
) -> [f32; N] {
    let mut lanes = [[0.0f32; LANES]; N];
    let whole = inputs[0].len() / LANES;
    let chunks = inputs.map(|input| input.as_chunks::<LANES>());
    for k in 0..whole {
        let chunk = chunks.map(|(chunks, _)| &chunks[k]);
        for lane in 0..LANES {
            let values = f(chunk.map(|chunk| chunk[lane]));
            (0..N).for_each(|n| lanes[n][lane] += values[n]);
        }
    }
    for lane in 0..inputs[0].len() - whole * LANES {
        let values = f(chunks.map(|(_, rest)| rest[lane]));
        (0..N).for_each(|n| lanes[n][lane] += values[n]);
    }
    lanes.map(|lanes| {
        let eighths =
            lanes.as_chunks::<8>().0.iter().map(|eight| eight.iter().fold(0.0, |sum, value| sum + value));
        eighths.fold(0.0, |sum, value| sum + value)
    })
}
