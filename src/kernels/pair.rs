//! What the kernels that look at two frames' expansions share: reading them, four pixels side by side.

use glam::{BVec4A, Mat4, UVec4, Vec4};

/// Values four by four: a pixel's b_x, b_y, A_xx, A_yy, or one value of four pixels.
#[inline(always)]
pub(super) fn fours(values: &[f32]) -> &[[f32; 4]] {
    values.as_chunks().0
}

#[inline(always)]
fn transpose([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let turned = Mat4::from_cols(a, b, c, d).transpose();
    [turned.x_axis, turned.y_axis, turned.z_axis, turned.w_axis]
}

/// The expansions of two frames.
pub(super) struct Pair<'a> {
    pub(super) quad_0: &'a [[f32; 4]],
    pub(super) cross_term_0: &'a [f32],
    pub(super) quad_1: &'a [[f32; 4]],
    pub(super) cross_term_1: &'a [f32],
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) stride: usize,
}

/// What the two frames say together at four pixels: A the mean of both, and b = −½ (b2 − b1).
///
/// Where the second frame has no expansion, the first one's stands alone and says nothing of motion: b2 = b1 = 0.
pub(super) struct Model {
    pub(super) a_xx: Vec4,
    pub(super) a_xy: Vec4,
    pub(super) a_yy: Vec4,
    pub(super) b_x: Vec4,
    pub(super) b_y: Vec4,
    /// At which pixels the second frame has an expansion.
    pub(super) inside: BVec4A,
}

impl Model {
    /// AᵀA: xx, xy, yy.
    #[inline(always)]
    pub(super) fn squared(&self) -> [Vec4; 3] {
        let Self { a_xx, a_xy, a_yy, .. } = *self;
        [a_xx * a_xx + a_xy * a_xy, (a_xx + a_yy) * a_xy, a_yy * a_yy + a_xy * a_xy]
    }
}

impl Pair<'_> {
    /// The model of the four pixels from column `4 four` on, for a flow of `d`.
    #[inline(always)]
    pub(super) fn model(&self, four: usize, y: usize, d: [Vec4; 2]) -> Model {
        let x = (UVec4::new(0, 1, 2, 3) + 4 * four as u32).min(UVec4::splat(self.width as u32 - 1));
        let (second, cross_term_1, inside) = self.second(x.as_vec4() + d[0], d[1] + y as f32);
        let at = y * self.stride + 4 * four;
        let quads = &self.quad_0[at..][..4];
        let first = transpose([0, 1, 2, 3].map(|i| Vec4::from_array(quads[i])));
        let cross_term_0 = Vec4::from_slice(&self.cross_term_0[at..]);
        let or = |both: Vec4, alone: Vec4| Vec4::select(inside, both, alone);
        let half = |c: usize| or(0.5 * (first[c] - second[c]), 0.5 * first[c]);
        let mean = |c: usize| or(0.5 * (first[c] + second[c]), first[c]);
        let a_xy = or(0.25 * (cross_term_0 + cross_term_1), 0.5 * cross_term_0);
        Model { a_xx: mean(2), a_xy, a_yy: mean(3), b_x: half(0), b_y: half(1), inside }
    }

    /// The second frame's expansions at four places, and at which of them there are four pixels around the place.
    /// Elsewhere the expansion is numbers without meaning.
    #[inline(always)]
    fn second(&self, x: Vec4, y: Vec4) -> ([Vec4; 4], Vec4, BVec4A) {
        let within = |at: Vec4, n: usize| at.cmpge(Vec4::ZERO) & at.cmplt(Vec4::splat((n - 1) as f32));
        // A place that is not a number is not inside either.
        let inside = within(x, self.width) & within(y, self.height);
        let (x, y) = (Vec4::select(inside, x, Vec4::ZERO), Vec4::select(inside, y, Vec4::ZERO));
        let (left, above) = (x.as_uvec4(), y.as_uvec4());
        let (fx, fy) = (x - left.as_vec4(), y - above.as_vec4());
        let (gx, gy) = (1.0 - fx, 1.0 - fy);
        let weights = transpose([gx * gy, fx * gy, gx * fy, fx * fy]);
        let first = above * self.stride as u32 + left;
        let mut quads = [Vec4::ZERO; 4];
        let mut cross_terms = [0.0; 4];
        for i in 0..4 {
            let first = first[i] as usize;
            let (right, below) = if inside.test(i) { (1, self.stride) } else { (0, 0) };
            let places = [first, first + right, first + below, first + below + right];
            let [a, b, c, d] = places.map(|at| Vec4::from_array(self.quad_1[at]));
            let w = weights[i];
            quads[i] = a * w.x + b * w.y + c * w.z + d * w.w;
            cross_terms[i] = Vec4::from_array(places.map(|at| self.cross_term_1[at])).dot(w);
        }
        (transpose(quads), Vec4::from_array(cross_terms), inside)
    }
}

/// How much pixels near the border count: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
#[inline(always)]
pub(super) fn border_weight(i: usize, n: usize) -> f32 {
    let step = |distance: usize| match distance {
        0 | 1 => 0.14,
        2..=4 => 0.4472,
        _ => 1.0,
    };
    step(i) * step(n - 1 - i)
}
