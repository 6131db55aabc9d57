//! Tables that the kernels read: weights and places, computed once in `f64` and shared by both executors.

/// A Gaussian of `taps` samples (odd) that sums to 1.
///
/// A sigma that is not positive stands for the binomial `[1 2 1]/4` of three taps, as in OpenCV's `getGaussianKernel`.
pub fn gauss(sigma: f64, taps: u32) -> Vec<f32> {
    if !(sigma > 0.0) {
        return vec![0.25, 0.5, 0.25];
    }
    let radius = f64::from(taps / 2);
    let weight = |i: u32| (-(f64::from(i) - radius).powi(2) / (2.0 * sigma * sigma)).exp();
    let sum: f64 = (0..taps).map(weight).sum();
    (0..taps).map(|i| (weight(i) / sum) as f32).collect()
}

/// The places at which a row of `out` samples reads a row of `inner` samples: one pair per output sample of a whole
/// index and a fraction, clamped to the row.
///
/// The sample centres are aligned: `x_in = (x_out + ½) · in/out − ½`, in the precision of OpenCV's `resize`.
pub fn place(inner: u32, out: u32) -> Vec<f32> {
    let scale = 1.0 / (f64::from(out) / f64::from(inner));
    (0..out)
        .flat_map(|i| {
            let at = ((f64::from(i) + 0.5) * scale - 0.5) as f32;
            let whole = at.floor();
            if whole < 0.0 {
                [0.0, 0.0]
            } else if whole >= (inner - 1) as f32 {
                [(inner - 1) as f32, 0.0]
            } else {
                [whole, at - whole]
            }
        })
        .collect()
}

/// The samples of a row of `inner` that each of `out ≤ inner` wider samples covers, four values each: the first index,
/// the count, and the weights of the first and of the last sample relative to 1 for those between. Slivers under 10⁻³
/// are left out, as OpenCV's `resize` does.
pub fn cover(inner: u32, out: u32) -> Vec<f32> {
    let scale = 1.0 / (f64::from(out) / f64::from(inner));
    let last = f64::from(inner - 1);
    (0..out)
        .flat_map(|i| {
            let begin = f64::from(i) * scale;
            let end = begin + scale;
            let whole_end = end.floor().min(last);
            let whole_begin = begin.ceil().min(whole_end);
            let (mut first, mut first_weight) = (whole_begin, 1.0);
            if whole_begin - begin > 1e-3 {
                (first, first_weight) = (whole_begin - 1.0, whole_begin - begin);
            }
            let (mut count, mut last_weight) = (whole_end - first, 1.0);
            if end - whole_end > 1e-3 || count < 1.0 {
                (count, last_weight) = (count + 1.0, (end - whole_end).clamp(1e-3, 1.0));
            }
            [first as f32, count as f32, first_weight as f32, last_weight as f32]
        })
        .collect()
}

/// The weights of the window over which the equations are averaged: `2 · (size / 2) + 1` weights.
///
/// A box has weights of `1 / size²` in both directions together, so of `1 / size` here; an even size has one sample
/// more than its weights account for, as in OpenCV. The Gaussian has a sigma of `0.3 · (size / 2)`. The size is at
/// least 2.
pub fn window(size: u32, gaussian: bool) -> Vec<f32> {
    let radius = size / 2;
    let taps = 2 * radius + 1;
    match gaussian {
        true => gauss(0.3 * f64::from(radius), taps),
        false => vec![(1.0 / f64::from(size)) as f32; taps as usize],
    }
}

/// The window for a kernel that reads four samples at once, from the given number of samples before the centre on:
/// zeros, the weights, then zeros up to a multiple of four.
pub fn window_from(window: &[f32], before: usize) -> Vec<f32> {
    let mut padded = vec![0.0; before - window.len() / 2];
    padded.extend(window);
    padded.resize(padded.len().next_multiple_of(4), 0.0);
    padded
}

/// The applicability of the polynomial expansion and the inverse of its normal matrix.
#[derive(Clone, Debug)]
pub struct Applicability {
    /// `(g, x g, x² g, 0)` for x from −radius to radius; g sums to 1.
    pub weights: Vec<f32>,
    /// Element (x, x) of the inverse normal matrix, equal to (y, y).
    pub inv_x: f32,
    /// Element (1, x²), equal to (1, y²).
    pub inv_1_xx: f32,
    /// Element (x², x²), equal to (y², y²).
    pub inv_xx: f32,
    /// Element (xy, xy).
    pub inv_xy: f32,
}

/// The applicability for a kernel that reads four samples at once, from the given number of samples before the centre
/// on: four samples of g, four of x g, four of x² g, then the next, with zeros around them as in [`window_from`].
pub fn applicability_from(weights: &[f32], before: usize) -> Vec<f32> {
    let power = |n: usize| -> Vec<f32> {
        let own: Vec<f32> = weights.as_chunks::<4>().0.iter().map(|four| four[n]).collect();
        window_from(&own, before)
    };
    let powers = [power(0), power(1), power(2)];
    (0..powers[0].len())
        .step_by(4)
        .flat_map(|i| powers.each_ref().map(|p| p[i..i + 4].to_vec()))
        .flatten()
        .collect()
}

/// The Gaussian applicability of the given radius and sigma, for the basis 1, x, y, x², y², xy.
///
/// With m₂ and m₄ its moments, the normal matrix decomposes into m₂ for x and y, m₂² for xy, and the 3×3 block
/// `[1 m₂ m₂; m₂ m₄ m₂²; m₂ m₂² m₄]` for 1, x², y², whose inverse has the closed form below. A sigma below the smallest
/// `f32` step stands for `0.3 · radius`.
pub fn applicability(radius: u32, sigma: f64) -> Applicability {
    let sigma = if sigma < f64::from(f32::EPSILON) { 0.3 * f64::from(radius) } else { sigma };
    let x = |i: u32| f64::from(i) - f64::from(radius);
    let raw = |i: u32| f64::from((-x(i).powi(2) / (2.0 * sigma * sigma)).exp() as f32);
    let taps = 2 * radius + 1;
    let sum: f64 = (0..taps).map(raw).sum();
    let g: Vec<f64> = (0..taps).map(|i| f64::from((raw(i) / sum) as f32)).collect();
    let moment = |power: i32| -> f64 { (0..taps).map(|i| g[i as usize] * x(i).powi(power)).sum() };
    let (m0, m2, m4) = (moment(0), moment(2), moment(4));
    // The block is [p q q; q r s; q s r] with the products of the moments in x and y.
    let (p, q, r, s) = (m0 * m0, m0 * m2, m0 * m4, m2 * m2);
    // By (r + s) and (r − s), the eigenvalues of its symmetric and antisymmetric part in x², y².
    let det = p * (r + s) - 2.0 * q * q;
    Applicability {
        weights: (0..taps)
            .flat_map(|i| {
                [g[i as usize], g[i as usize] * x(i), g[i as usize] * x(i) * x(i), 0.0].map(|v| v as f32)
            })
            .collect(),
        inv_x: (1.0 / q) as f32,
        inv_1_xx: (-q / det) as f32,
        inv_xx: (0.5 * (p / det + 1.0 / (r - s))) as f32,
        inv_xy: (1.0 / s) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_align_sample_centres() {
        assert_eq!(place(8, 4), [0.0, 0.5, 2.0, 0.5, 4.0, 0.5, 6.0, 0.5]);
        assert_eq!(place(2, 4), [0.0, 0.0, 0.0, 0.25, 0.0, 0.75, 1.0, 0.0]);
        assert_eq!(place(1, 1), [0.0, 0.0]);
    }

    #[test]
    fn covers_weigh_every_sample_once() {
        for (inner, out) in [(7, 7), (10, 7), (200, 160), (9, 1), (97, 61)] {
            let mut weights = vec![0.0; inner as usize];
            for cover in cover(inner, out).as_chunks::<4>().0 {
                let [first, count, first_weight, last_weight] = *cover;
                for k in 0..count as usize {
                    let weight = match k {
                        0 => first_weight,
                        _ if k + 1 == count as usize => last_weight,
                        _ => 1.0,
                    };
                    weights[first as usize + k] += weight;
                }
            }
            assert!(weights.iter().all(|w| (w - 1.0f32).abs() < 2e-3), "{inner} → {out}: {weights:?}");
        }
    }

    #[test]
    fn inverse_normal_matrix_inverts() {
        let a = applicability(5, 1.2);
        let g: Vec<f64> = a.weights.chunks(4).map(|w| f64::from(w[0])).collect();
        let moment =
            |n: i32| -> f64 { g.iter().enumerate().map(|(i, g)| g * (i as f64 - 5.0).powi(n)).sum() };
        let (m2, m4) = (moment(2), moment(4));
        let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-6, "{value} {expected}");
        near(f64::from(a.inv_x) * m2, 1.0);
        near(f64::from(a.inv_xy) * m2 * m2, 1.0);
        // The row of x² times the columns of 1 and of x²; the rest of that row follows from the sum.
        let (i_1, i_xx) = (f64::from(a.inv_1_xx), f64::from(a.inv_xx));
        let i_yy = -(i_1 * m2 + i_xx * m2 * m2) / m4;
        near(i_1 + (i_xx + i_yy) * m2, 0.0);
        near(i_1 * m2 + i_xx * m4 + i_yy * m2 * m2, 1.0);
    }
}
