//! Shared by the kernels that read two frames' expansions: sampling the second one where the flow points.

use super::parallel_rows::{Split, bands};

/// Number of pixels per block: few enough that their values stay in the nearest cache.
pub(super) const BLOCK: usize = 64;

/// One value per pixel of a block.
pub(super) type Block = [f32; BLOCK];

/// Values four by four: a pixel's b_x, b_y, A_xx, A_yy.
#[inline(always)]
pub(super) fn fours(values: &[f32]) -> &[[f32; 4]] {
    values.as_chunks().0
}

/// The expansions of two frames.
pub(super) struct ExpansionPair<'a> {
    pub(super) quad_0: &'a [[f32; 4]],
    pub(super) cross_term_0: &'a [f32],
    pub(super) quad_1: &'a [[f32; 4]],
    pub(super) cross_term_1: &'a [f32],
    /// The certainty of the second expansion; `None` for 1 everywhere.
    pub(super) certainty_1: Option<&'a [f32]>,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) stride: usize,
    /// The share of its Hessian by which each of the four expansions around a place is continued to the place, before the
    /// slopes are averaged; 0 averages the slopes as they are.
    pub(super) kappa: f32,
    /// The time of the second expansion, in displacements from the first one: 1 for the second frame of a pair.
    pub(super) time: f32,
}

/// The common model of the two frames at a block of pixels: A the mean of both, and b = −½ (b2 − b1).
///
/// Where the second frame has no expansion, the first one's is used alone and contains no motion: b2 = b1 = 0.
#[repr(align(64))]
pub(super) struct Model {
    pub(super) a_xx: Block,
    pub(super) a_xy: Block,
    pub(super) a_yy: Block,
    pub(super) b_x: Block,
    pub(super) b_y: Block,
    /// 1 where the second frame has an expansion, else 0.
    pub(super) inside: Block,
    /// The certainty of the second frame's expansion there.
    pub(super) certainty_1: Block,
}

/// Where a block of pixels is read: the pixel above and to the left, and the bilinear weights of it and of its
/// neighbours to the right, below, and below to the right. Aligned, because a value that spans two cache lines is slow
/// to load.
#[repr(align(64))]
struct Places {
    first: [u32; BLOCK],
    weights: [Block; 4],
    /// The place's distance from the pixel above and to the left, along x and along y.
    fraction: [Block; 2],
    inside: Block,
}

/// The values read there: the weighted mean, and the four cross terms separately.
#[repr(align(64))]
struct Gathered {
    quads: [[f32; 4]; BLOCK],
    cross_terms: [[f32; 4]; BLOCK],
    /// The sums by which A_xx and A_yy continue the slopes.
    continued: [[f32; 2]; BLOCK],
}

impl ExpansionPair<'_> {
    /// The model of a block of pixels of row `y` from column `x0` on, displaced by `u` and `v`.
    #[inline(always)]
    fn model(&self, x0: usize, y: usize, block: &Ours<'_>) -> Model {
        let places = self.places(x0, y, block.u, block.v);
        let (second, cross_terms, certainty_1) = match self.certainty_1 {
            None if self.kappa == 0.0 => self.second::<false>(&places),
            None => self.second::<true>(&places),
            Some(certainty) => self.weighted_second(&places, certainty),
        };
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
        for i in 0..BLOCK {
            let (q, p) = (block.quad_0[i], second[i]);
            let inside = places.inside[i] > 0.0;
            let or = |both: f32, alone: f32| if inside { both } else { alone };
            model.b_x[i] = 0.5 * or(q[0] - p[0], q[0]);
            model.b_y[i] = 0.5 * or(q[1] - p[1], q[1]);
            model.a_xx[i] = or(0.5 * (q[2] + p[2]), q[2]);
            model.a_yy[i] = or(0.5 * (q[3] + p[3]), q[3]);
            let t = block.cross_term_0[i];
            model.a_xy[i] = 0.5 * or(0.5 * (t + cross_terms[i]), t);
        }
        model
    }

    #[inline(always)]
    fn places(&self, x0: usize, y: usize, u: &Block, v: &Block) -> Places {
        let zero = [0.0; BLOCK];
        let mut places = Places { first: [0; BLOCK], weights: [zero; 4], fraction: [zero; 2], inside: zero };
        let (right, bottom) = ((self.width - 1) as f32, (self.height - 1) as f32);
        let (stride, x0, y) = (self.stride as u32, x0 as u32, y as f32);
        for i in 0..BLOCK {
            let x = ((x0 + i as u32) as f32).min(right) + self.time * u[i];
            let y = y + self.time * v[i];
            // NaN is not inside either.
            let inside = (x >= 0.0) & (y >= 0.0) & (x < right) & (y < bottom);
            let (x, y) = if inside { (x, y) } else { (0.0, 0.0) };
            let (left, above) = (x.floor(), y.floor());
            let (fx, fy) = (x - left, y - above);
            places.first[i] = whole(above) * stride + whole(left);
            places.weights[0][i] = (1.0 - fx) * (1.0 - fy);
            places.weights[1][i] = fx * (1.0 - fy);
            places.weights[2][i] = (1.0 - fx) * fy;
            places.weights[3][i] = fx * fy;
            (places.fraction[0][i], places.fraction[1][i]) = (fx, fy);
            places.inside[i] = if inside { 1.0 } else { 0.0 };
        }
        places
    }

    /// The distance of the row below, and the number of pixels with a row below and a right neighbour.
    #[inline(always)]
    fn neighbours(&self) -> (usize, usize) {
        // In an image one pixel high no place is inside, so that any row will do. An image one pixel wide still has
        // surplus.
        let below = if self.height > 1 { self.stride } else { 0 };
        (below, self.stride * self.height - below - 1)
    }

    /// The second frame's expansions there. They have no meaning at places without four pixels around them.
    #[inline(always)]
    fn second<const CONTINUED: bool>(&self, places: &Places) -> ([[f32; 4]; BLOCK], Block, Block) {
        let mut gathered = Gathered {
            quads: [[0.0; 4]; BLOCK],
            cross_terms: [[0.0; 4]; BLOCK],
            continued: [[0.0; 2]; BLOCK],
        };
        // All slices have the same length, so that one bounds check serves all of them.
        let (below, count) = self.neighbours();
        let (q, t) = (self.quad_1, self.cross_term_1);
        let (q_a, q_b) = (&q[..count], &q[1..][..count]);
        let (q_c, q_d) = (&q[below..][..count], &q[below + 1..][..count]);
        let (t_a, t_b) = (&t[..count], &t[1..][..count]);
        let (t_c, t_d) = (&t[below..][..count], &t[below + 1..][..count]);
        for i in 0..BLOCK {
            let first = places.first[i] as usize;
            let [a, b, c, d] = places.weights.each_ref().map(|weights| weights[i]);
            let (q_a, q_b, q_c, q_d) = (q_a[first], q_b[first], q_c[first], q_d[first]);
            gathered.quads[i] = std::array::from_fn(|n| a * q_a[n] + b * q_b[n] + c * q_c[n] + d * q_d[n]);
            gathered.cross_terms[i] = [t_a[first], t_b[first], t_c[first], t_d[first]];
            if CONTINUED {
                // From each of the four pixels to the place, along x and along y.
                let [fx, fy] = places.fraction.each_ref().map(|fraction| fraction[i]);
                let (gx, gy) = (fx - 1.0, fy - 1.0);
                gathered.continued[i] = [
                    (a * q_a[2] + c * q_c[2]) * fx + (b * q_b[2] + d * q_d[2]) * gx,
                    (a * q_a[3] + b * q_b[3]) * fy + (c * q_c[3] + d * q_d[3]) * gy,
                ];
            }
        }
        let mut cross_terms = [0.0; BLOCK];
        for i in 0..BLOCK {
            let [a, b, c, d] = places.weights.each_ref().map(|weights| weights[i]);
            let [t_a, t_b, t_c, t_d] = gathered.cross_terms[i];
            cross_terms[i] = a * t_a + b * t_b + c * t_c + d * t_d;
            if CONTINUED {
                let [fx, fy] = places.fraction.each_ref().map(|fraction| fraction[i]);
                let (gx, gy) = (fx - 1.0, fy - 1.0);
                let along_x = (a * t_a + b * t_b) * fy + (c * t_c + d * t_d) * gy;
                let along_y = (a * t_a + c * t_c) * fx + (b * t_b + d * t_d) * gx;
                let [xx, yy] = gathered.continued[i];
                gathered.quads[i][0] += self.kappa * (2.0 * xx + along_x);
                gathered.quads[i][1] += self.kappa * (2.0 * yy + along_y);
            }
        }
        (gathered.quads, cross_terms, [1.0; BLOCK])
    }

    /// The same weighted by certainty too, so that pixels without an expansion do not draw the mean towards zero; and
    /// its certainty.
    #[inline(always)]
    fn weighted_second(&self, places: &Places, certainty: &[f32]) -> ([[f32; 4]; BLOCK], Block, Block) {
        let mut sums = [0.0; BLOCK];
        let Places { first, weights, fraction, inside } = *places;
        let mut weighted = Places { first, weights, fraction, inside };
        let (below, count) = self.neighbours();
        let corners = [0, 1, below, below + 1].map(|offset| &certainty[offset..][..count]);
        for i in 0..BLOCK {
            let first = places.first[i] as usize;
            for (weights, certainty) in weighted.weights.iter_mut().zip(corners) {
                weights[i] *= certainty[first];
            }
            let [a, b, c, d] = weighted.weights.each_ref().map(|weights| weights[i]);
            sums[i] = a + b + c + d;
        }
        let (mut quads, mut cross_terms, _) = match self.kappa == 0.0 {
            true => self.second::<false>(&weighted),
            false => self.second::<true>(&weighted),
        };
        for i in 0..BLOCK {
            quads[i] = quads[i].map(|value| value / sums[i]);
            cross_terms[i] /= sums[i];
        }
        (quads, cross_terms, sums)
    }
}

/// A whole number from 0 to 2²³ as an integer. Unlike the cast it needs no care for values out of range, for which
/// processors have no vector instruction.
#[inline(always)]
fn whole(value: f32) -> u32 {
    const SHIFT: f32 = 8_388_608.0; // 2²³: from here on a number's last bit counts ones
    (value + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits())
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
    /// The number of valid pixels in the block. The results of the others are discarded.
    pub(super) count: usize,
    /// Their displacements so far.
    pub(super) u: &'a Block,
    pub(super) v: &'a Block,
    /// Their weights near the left and right border, and the weight of the whole row near the upper and lower one.
    pub(super) weights_x: &'a Block,
    pub(super) weight_y: f32,
}

/// The first frame's values of a block.
struct Ours<'a> {
    u: &'a Block,
    v: &'a Block,
    quad_0: &'a [[f32; 4]; BLOCK],
    cross_term_0: &'a Block,
}

/// A block of `values` from `at` on, of which `count` belong to it: the values themselves, or a copy in `room`, so that
/// everything after it processes whole blocks.
#[inline(always)]
fn whole_block<'a, T: Copy>(
    values: &'a [T],
    at: usize,
    count: usize,
    room: &'a mut [T; BLOCK],
) -> &'a [T; BLOCK] {
    if count == BLOCK
        && let Some(block) = values[at..].first_chunk()
    {
        return block;
    }
    room[..count].copy_from_slice(&values[at..][..count]);
    room
}

impl ExpansionPair<'_> {
    /// Fills an image of five channels, which `f` computes from a block's model. Overflow and NaN become zeros, so that
    /// they do not spread.
    #[inline(always)]
    pub(super) fn each_block(
        &self,
        out: &mut [f32],
        flow: &[f32],
        f: impl Fn(&Model, &Stretch<'_>) -> [Block; 5] + Sync,
    ) {
        self.each_block_into(
            [out, &mut []],
            5,
            flow,
            #[inline(always)]
            |model, stretch| {
                let mut channels = f(model, stretch);
                zero_unknown(&mut channels);
                channels
            },
        );
    }

    /// Fills two planes, which `f` computes from a block's model.
    #[inline(always)]
    pub(super) fn each_block_of_two(
        &self,
        first: &mut [f32],
        second: &mut [f32],
        flow: &[f32],
        f: impl Fn(&Model, &Stretch<'_>) -> [Block; 2] + Sync,
    ) {
        self.each_block_into([first, second], 1, flow, f);
    }

    /// Fills an image of so many channels and, with the channels that are left, a plane each of a second image.
    #[inline(always)]
    fn each_block_into<const N: usize>(
        &self,
        [out, second]: [&mut [f32]; 2],
        channels_of_first: usize,
        flow: &[f32],
        f: impl Fn(&Model, &Stretch<'_>) -> [Block; N] + Sync,
    ) {
        let stride = self.stride;
        let row = channels_of_first * stride;
        let split = Split {
            second_row: N * stride - row,
            scratch: stride.next_multiple_of(BLOCK),
            ..Split::rows_of(row)
        };
        bands(
            out,
            second,
            split,
            #[inline(always)]
            |band| {
                for (x, weight) in band.scratch.iter_mut().enumerate() {
                    *weight = border_weight(x.min(self.width - 1), self.width);
                }
                let mut room = [[0.0; BLOCK]; 3];
                let mut room_of_quads = [[0.0; 4]; BLOCK];
                let mut second_rows = band.second.chunks_exact_mut((N * stride - row).max(1));
                for (i, rows) in band.out.chunks_exact_mut(row).enumerate() {
                    let y = band.y0 + i;
                    let mut second_rows = second_rows.next();
                    let weight_y = border_weight(y, self.height);
                    let (u, v) = flow[2 * y * stride..][..2 * stride].split_at(stride);
                    for (block, weights_x) in band.scratch.as_chunks().0.iter().enumerate() {
                        let x0 = block * BLOCK;
                        let (at, count) = (y * stride + x0, BLOCK.min(stride - x0));
                        let [room_u, room_v, room_of_cross_terms] = &mut room;
                        let (u, v) = (whole_block(u, x0, count, room_u), whole_block(v, x0, count, room_v));
                        let quad_0 = whole_block(self.quad_0, at, count, &mut room_of_quads);
                        let cross_term_0 = whole_block(self.cross_term_0, at, count, room_of_cross_terms);
                        let model = self.model(x0, y, &Ours { u, v, quad_0, cross_term_0 });
                        let channels = f(&model, &Stretch { at, count, u, v, weights_x, weight_y });
                        for (channel, values) in channels.iter().enumerate() {
                            let rows = match (channel.checked_sub(channels_of_first), &mut second_rows) {
                                (Some(channel), Some(rows)) => &mut rows[channel * stride..][..stride],
                                _ => &mut rows[channel * stride..][..stride],
                            };
                            let out = &mut rows[x0..][..count];
                            match out.as_mut_array() {
                                Some(out) => *out = *values,
                                None => out.copy_from_slice(&values[..count]),
                            }
                        }
                    }
                }
            },
        );
    }
}

/// Overflow and NaN become zeros.
#[inline(always)]
pub(super) fn zero_unknown(channels: &mut [Block; 5]) {
    for i in 0..BLOCK {
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

/// The weights of pixels near the border: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
#[inline(always)]
fn border_weight(i: usize, n: usize) -> f32 {
    let step = |distance: usize| match distance {
        0 | 1 => 0.14,
        2..=4 => 0.4472,
        _ => 1.0,
    };
    step(i) * step(n - 1 - i)
}
