//! What the kernels that look at two frames' expansions share: reading the second one where the flow points.

use super::rows::{Split, bands};

/// Pixels worked on at a time: few enough that what is known of them stays in the nearest cache.
pub(super) const BLOCK: usize = 64;

/// One value each of a block of pixels.
pub(super) type Block = [f32; BLOCK];

/// Values four by four: a pixel's b_x, b_y, A_xx, A_yy.
#[inline(always)]
pub(super) fn fours(values: &[f32]) -> &[[f32; 4]] {
    values.as_chunks().0
}

/// The expansions of two frames.
pub(super) struct Pair<'a> {
    pub(super) quad_0: &'a [[f32; 4]],
    pub(super) cross_term_0: &'a [f32],
    pub(super) quad_1: &'a [[f32; 4]],
    pub(super) cross_term_1: &'a [f32],
    /// How certain the second expansion is; none for equally everywhere.
    pub(super) certainty_1: Option<&'a [f32]>,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) stride: usize,
}

/// What the two frames say together at a block of pixels: A the mean of both, and b = −½ (b2 − b1).
///
/// Where the second frame has no expansion, the first one's stands alone and says nothing of motion: b2 = b1 = 0.
pub(super) struct Model {
    pub(super) a_xx: Block,
    pub(super) a_xy: Block,
    pub(super) a_yy: Block,
    pub(super) b_x: Block,
    pub(super) b_y: Block,
    /// 1 where the second frame has an expansion, else 0.
    pub(super) inside: Block,
    /// How certain the second frame's expansion is there.
    pub(super) certainty_1: Block,
}

/// Where a block of pixels is read: the pixel above and to the left, and how far from it.
struct Places {
    first: [u32; BLOCK],
    fx: Block,
    fy: Block,
    inside: Block,
}

impl Pair<'_> {
    /// The model of the pixels of row `y` from column `x0` on, as many as `u` and `v` hold displacements of.
    #[inline(always)]
    fn model(&self, x0: usize, y: usize, u: &[f32], v: &[f32]) -> Model {
        let count = u.len();
        let places = self.places(x0, y, u, v);
        let (second, cross_terms, certainty_1) = match self.certainty_1 {
            None => self.second(&places, count, |_, weights| weights),
            Some(certainty) => self
                .second(&places, count, |at, weights| std::array::from_fn(|i| weights[i] * certainty[at[i]])),
        };
        let at = y * self.stride + x0;
        let (quad_0, cross_term_0) = (&self.quad_0[at..][..count], &self.cross_term_0[at..][..count]);
        let zero = [0.0; BLOCK];
        let mut model = Model {
            a_xx: zero,
            a_xy: zero,
            a_yy: zero,
            b_x: zero,
            b_y: zero,
            inside: places.inside,
            certainty_1,
        };
        for i in 0..count {
            let (q, p) = (quad_0[i], second[i]);
            let inside = places.inside[i] > 0.0;
            let or = |both: f32, alone: f32| if inside { both } else { alone };
            model.b_x[i] = 0.5 * or(q[0] - p[0], q[0]);
            model.b_y[i] = 0.5 * or(q[1] - p[1], q[1]);
            model.a_xx[i] = or(0.5 * (q[2] + p[2]), q[2]);
            model.a_yy[i] = or(0.5 * (q[3] + p[3]), q[3]);
            let t = cross_term_0[i];
            model.a_xy[i] = 0.5 * or(0.5 * (t + cross_terms[i]), t);
        }
        model
    }

    #[inline(always)]
    fn places(&self, x0: usize, y: usize, u: &[f32], v: &[f32]) -> Places {
        let zero = [0.0; BLOCK];
        let mut places = Places { first: [0; BLOCK], fx: zero, fy: zero, inside: zero };
        let (right, bottom) = ((self.width - 1) as f32, (self.height - 1) as f32);
        let (stride, x0, y) = (self.stride as u32, x0 as u32, y as f32);
        for (i, (u, v)) in u.iter().zip(v).enumerate() {
            let x = ((x0 + i as u32) as f32).min(right) + u;
            let y = y + v;
            // A place that is not a number is not inside either.
            let inside = (x >= 0.0) & (y >= 0.0) & (x < right) & (y < bottom);
            let (x, y) = if inside { (x, y) } else { (0.0, 0.0) };
            let (left, above) = (x as i32, y as i32);
            places.first[i] = above as u32 * stride + left as u32;
            places.fx[i] = x - left as f32;
            places.fy[i] = y - above as f32;
            places.inside[i] = if inside { 1.0 } else { 0.0 };
        }
        places
    }

    /// The second frame's expansions there, and the sums of the weights by which they are means of the four pixels around.
    /// Where there are not four pixels around a place they are without meaning.
    #[inline(always)]
    fn second(
        &self,
        places: &Places,
        count: usize,
        weigh: impl Fn([usize; 4], [f32; 4]) -> [f32; 4],
    ) -> ([[f32; 4]; BLOCK], Block, Block) {
        let mut quads = [[0.0; 4]; BLOCK];
        let mut cross_terms = [0.0; BLOCK];
        let mut sums = [1.0; BLOCK];
        // A picture one pixel wide or high has no neighbours to read, and nothing is inside it.
        let right = usize::from(self.width > 1);
        let below = if self.height > 1 { self.stride } else { 0 };
        for i in 0..count {
            let first = places.first[i] as usize;
            let (fx, fy) = (places.fx[i], places.fy[i]);
            let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
            let at = [first, first + right, first + below, first + below + right];
            let [a, b, c, d] = weigh(at, weights);
            let (top, bottom) = (&self.quad_1[at[0]..=at[1]], &self.quad_1[at[2]..=at[3]]);
            let (q_a, q_b, q_c, q_d) = (top[0], top[right], bottom[0], bottom[right]);
            quads[i] = std::array::from_fn(|n| a * q_a[n] + b * q_b[n] + c * q_c[n] + d * q_d[n]);
            let (top, bottom) = (&self.cross_term_1[at[0]..=at[1]], &self.cross_term_1[at[2]..=at[3]]);
            cross_terms[i] = a * top[0] + b * top[right] + c * bottom[0] + d * bottom[right];
            if self.certainty_1.is_some() {
                // A mean by weight and certainty: pixels without an expansion do not draw it towards nothing.
                let sum = a + b + c + d;
                quads[i] = quads[i].map(|value| value / sum);
                cross_terms[i] /= sum;
                sums[i] = sum;
            }
        }
        (quads, cross_terms, sums)
    }
}

/// AᵀA of a symmetric A: xx, xy, yy.
#[inline(always)]
pub(super) fn squared(a_xx: f32, a_xy: f32, a_yy: f32) -> [f32; 3] {
    [a_xx * a_xx + a_xy * a_xy, (a_xx + a_yy) * a_xy, a_yy * a_yy + a_xy * a_xy]
}

/// A block of neighbouring pixels in a row.
pub(super) struct Stretch<'a> {
    /// The first one's place in a plane.
    pub(super) at: usize,
    /// Their displacements so far.
    pub(super) u: &'a [f32],
    pub(super) v: &'a [f32],
    /// How much they count for their nearness to the left and right border, and all of them for that to the other two.
    pub(super) weights_x: &'a [f32],
    pub(super) weight_y: f32,
}

impl Pair<'_> {
    /// Fills a picture of five channels as `f` computes them of a block's model. What overflowed or was never a number
    /// says nothing: zeros keep that from spreading.
    #[inline(always)]
    pub(super) fn each_block(
        &self,
        out: &mut [f32],
        flow: &[f32],
        f: impl Fn(&Model, &Stretch<'_>) -> [Block; 5] + Sync,
    ) {
        let stride = self.stride;
        let split = Split { scratch: stride, ..Split::rows_of(5 * stride) };
        bands(
            out,
            &mut [],
            split,
            #[inline(always)]
            |band| {
                for (x, weight) in band.scratch.iter_mut().enumerate() {
                    *weight = border_weight(x.min(self.width - 1), self.width);
                }
                for (i, rows) in band.out.chunks_exact_mut(5 * stride).enumerate() {
                    let y = band.y0 + i;
                    let weight_y = border_weight(y, self.height);
                    let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
                    for x0 in (0..stride).step_by(BLOCK) {
                        let block = x0..stride.min(x0 + BLOCK);
                        let (u, v) = (&u[block.clone()], &v[block.clone()]);
                        let weights_x = &band.scratch[block.clone()];
                        let model = self.model(x0, y, u, v);
                        let mut channels =
                            f(&model, &Stretch { at: y * stride + x0, u, v, weights_x, weight_y });
                        zero_unknown(&mut channels, block.len());
                        for (channel, values) in channels.iter().enumerate() {
                            rows[channel * stride + x0..][..block.len()]
                                .copy_from_slice(&values[..block.len()]);
                        }
                    }
                }
            },
        );
    }
}

#[inline(always)]
fn zero_unknown(channels: &mut [Block; 5], count: usize) {
    for i in 0..count {
        let size = channels[0][i].abs()
            + channels[1][i].abs()
            + channels[2][i].abs()
            + channels[3][i].abs()
            + channels[4][i].abs();
        let known = size <= 1e30;
        for channel in &mut *channels {
            channel[i] = if known { channel[i] } else { 0.0 };
        }
    }
}

/// How much pixels near the border count: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
#[inline(always)]
fn border_weight(i: usize, n: usize) -> f32 {
    let step = |distance: usize| match distance {
        0 | 1 => 0.14,
        2..=4 => 0.4472,
        _ => 1.0,
    };
    step(i) * step(n - 1 - i)
}
