//! The displacement of each pixel by an affine motion model of its window: the horizontal half of the sums of
//! [`super::affine_columns`], and the solution of the normal equations.
//!
//! In a window the displacement is modelled as `p₀ + p₁ x + p₂ y`, with vectors p and the place (x, y) relative to the centre.
//! Equations `G d = q` of each pixel, summed with weights w, become the six equations
//! `Σ w m_i G Σ m_j p_j = Σ w m_i q` for the monomials m = (1, x, y) (G. Farnebäck, Two-frame motion estimation based on
//! polynomial expansion, SCIA 2003, section 4). The displacement of the centre is p₀. A small number on the diagonal keeps the
//! slopes p₁ and p₂ at zero where there is no texture to find them.

use super::affine_columns::{self, CHANNELS, powers};
use super::parallel_rows::{Split, bands, dimensions, repeat_last, weighted_sum};
use super::test_inputs::{Fill, planes};
use super::{solve, tables};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window, and the form of the solution.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` columns, with a radius from 1 to 512.
        radius: u32,
        /// The length of a pixel relative to the radius.
        step: f32,
        /// What is added to the diagonal of the normal matrix, above 0.
        regular: f32,
        /// 1 to add the solution to the flow so far, or 0.
        added: f32,
    }
}

kernel!(
    "solve_affine" + [],
    reference(Params; columns, window, so_far) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 0.0, of_largest: 0.0,
        reason: "the roundings of its own sums and of the elimination; and what is smaller than 10⁻³⁰ px a GPU may flush to zero",
    },
    rounding: rounding,
);

/// Which sums of a row make up G's and q's six and three moments: the first channel of `columns` and the power of x.
const MOMENTS: [(usize, usize); 9] = [(0, 0), (0, 1), (5, 0), (0, 2), (5, 1), (10, 0), (3, 0), (3, 1), (8, 0)];

/// The sums of a pixel: those of G's channels (xx, xy, yy) times 1, x, y, x², xy, y², then those of q's (x, y) times 1, x, y.
const SUMS: usize = 24;

fn reference(p: &Params, columns: &[f32], window: &[f32], so_far: &[f32], flow: &mut [f32]) {
    let stride = dimensions(p.width, p.height).2;
    each_row(p, columns, window, flow, 2, #[inline(always)] |y, sums, rows| {
        let (u, v) = rows.split_at_mut(stride);
        let (u_0, v_0) = so_far[2 * y * stride..][..2 * stride].split_at(stride);
        let width = p.width as usize;
        for x in 0..width {
            let [d_x, d_y] = displacement(normal_equations(|n| sums[n * width + x], p.regular));
            u[x] = p.added * u_0[x] + known(d_x);
            v[x] = p.added * v_0[x] + known(d_y);
        }
    });
}

/// Hands `f` the number of each row, its sums, one row of `width` values after the other, and the row of the result.
#[inline(always)]
fn each_row(
    p: &Params,
    columns: &[f32],
    window: &[f32],
    result: &mut [f32],
    channels: usize,
    f: impl Fn(usize, &[f32], &mut [f32]) + Sync,
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let taps = 2 * radius + 1;
    let padded = width + 2 * radius;
    let split = Split { scratch: 2 * taps + padded + SUMS * width, dearer: 16, ..Split::rows_of(channels * stride) };
    bands(result, &mut [], split, #[inline(always)] |band| {
        let (room, scratch) = band.scratch.split_at_mut(2 * taps);
        let weights = powers(&window[..taps], p.step, room);
        let (extended, sums) = scratch.split_at_mut(padded);
        // Columns outside the image have no weight.
        extended.fill(0.0);
        for (i, rows) in band.out.chunks_exact_mut(channels * stride).enumerate() {
            let y = band.y0 + i;
            let mut sums_left = sums.chunks_exact_mut(width);
            for (number, &(first, power)) in MOMENTS.iter().enumerate() {
                for channel in 0..if number < 6 { 3 } else { 2 } {
                    let row = &columns[(CHANNELS * y + first + channel) * stride..][..width];
                    extended[radius..radius + width].copy_from_slice(row);
                    let Some(sum) = sums_left.next() else { unreachable!("there are 24 sums") };
                    weighted_sum(sum, weights[power], |k| &extended[k..][..width]);
                }
            }
            f(y, sums, rows);
            for row in rows.chunks_exact_mut(stride) {
                repeat_last(row, width);
            }
        }
    });
}

/// The rows of the normal equations for u, v, ∂u/∂x, ∂v/∂x, ∂u/∂y, ∂v/∂y, with the right side as the seventh value, from a
/// pixel's sums.
#[inline(always)]
fn normal_equations<T: Copy + std::ops::Add<Output = T>>(sum: impl Fn(usize) -> T, regular: T) -> [[T; 7]; 6] {
    let g = |monomial: usize| [sum(3 * monomial), sum(3 * monomial + 1), sum(3 * monomial + 2)];
    let [one, x, y, xx, xy, yy] = [g(0), g(1), g(2), g(3), g(4), g(5)];
    let q = |n: usize| sum(18 + n);
    [
        [one[0] + regular, one[1], x[0], x[1], y[0], y[1], q(0)],
        [one[1], one[2] + regular, x[1], x[2], y[1], y[2], q(1)],
        [x[0], x[1], xx[0] + regular, xx[1], xy[0], xy[1], q(2)],
        [x[1], x[2], xx[1], xx[2] + regular, xy[1], xy[2], q(3)],
        [y[0], y[1], xy[0], xy[1], yy[0] + regular, yy[1], q(4)],
        [y[1], y[2], xy[1], xy[2], yy[1], yy[2] + regular, q(5)],
    ]
}

/// The first two unknowns, by elimination of the others. A symmetric matrix above zero needs no pivots.
#[inline(always)]
fn displacement(mut rows: [[f32; 7]; 6]) -> [f32; 2] {
    for pivot in (1..6).rev() {
        let of = rows[pivot];
        for row in rows.iter_mut().take(pivot) {
            let factor = row[pivot] / of[pivot];
            for (value, of) in row.iter_mut().zip(of) {
                *value -= factor * of;
            }
        }
    }
    let u = rows[0][6] / rows[0][0];
    [u, (rows[1][6] - rows[1][0] * u) / rows[1][1]]
}

/// Displacements beyond this become zero.
const LARGEST: f32 = 1e9;

#[inline(always)]
fn known(d: f32) -> f32 {
    if d.abs() <= LARGEST { d } else { 0.0 }
}

/// The largest difference that roundings may cause between the two sides' displacements, to first order.
///
/// Let M p = q be the six equations, n the number of terms of a sum, and S the sums of the terms' magnitudes. Sums differ by at
/// most `(n + 3) ε S` (three more for the weight's products and the diagonal). Elimination without pivots solves a system that
/// differs from M by `2 γ |L| |U|` (Higham, Accuracy and Stability of Numerical Algorithms, 2002, theorem 9.4), which for a
/// positive definite M is at most `2 γ √(M_ii M_jj)` (section 10.1); γ is 6 ε / 2, taken fourfold because a quotient of WGSL
/// may be off by 2.5 units in the last place, and for two sides. From both follows `|δp| ≤ |M⁻¹| (δM |p| + δq) / (1 − ρ)`,
/// where ρ is the largest row sum of `|M⁻¹| δM`. Where ρ is over ½, rounding decides the displacement.
fn rounding(p: &Params, columns: &[f32], window: &[f32], so_far: &[f32], bound: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let mut sums = vec![0.0; SUMS * stride * p.height as usize];
    each_row(p, columns, window, &mut sums, SUMS, |_, sums, rows| {
        for (row, sum) in rows.chunks_exact_mut(stride).zip(sums.chunks_exact(width)) {
            row[..width].copy_from_slice(sum);
        }
    });
    let sizes = magnitudes(p, columns, window);
    for (y, rows) in bound.chunks_exact_mut(2 * stride).enumerate() {
        for x in 0..stride {
            let at = |values: &[f32], n: usize| f64::from(values[(SUMS * y + n) * stride + x]);
            let regular = f64::from(p.regular);
            let exact = normal_equations(|n| at(&sums, n), regular);
            let size = normal_equations(|n| at(&sizes, n), regular);
            let so_far = [0, 1].map(|channel| so_far[(2 * y + channel) * stride + x.min(width - 1)]);
            let apart = apart(&exact, &size, f64::from(2 * p.radius + 1));
            for (channel, (apart, so_far)) in apart.into_iter().zip(so_far).enumerate() {
                rows[channel * stride + x] = apart + f32::EPSILON * (p.added * so_far.abs() + apart);
            }
        }
    }
}

/// Bounds of the sums of the terms' magnitudes, laid out as the sums: those without the factors t, which are at most 1.
fn magnitudes(p: &Params, columns: &[f32], window: &[f32]) -> Vec<f32> {
    let (width, height, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let mut all = vec![0.0; SUMS * stride * height];
    for (y, rows) in all.chunks_exact_mut(SUMS * stride).enumerate() {
        let mut rows = rows.chunks_exact_mut(stride);
        for (number, &(first, _)) in MOMENTS.iter().enumerate() {
            for channel in 0..if number < 6 { 3 } else { 2 } {
                let row = &columns[(CHANNELS * y + first + channel) * stride..][..width];
                let Some(sum) = rows.next() else { unreachable!("there are 24 sums") };
                for (x, sum) in sum.iter_mut().enumerate() {
                    let x = x.min(width - 1);
                    let (begin, end) = (radius.saturating_sub(x), (2 * radius + 1).min(width + radius - x));
                    *sum = (begin..end).map(|k| window[k] * row[x + k - radius].abs()).sum();
                }
            }
        }
    }
    all
}

/// The bounds of u and v from the equations, those of the magnitudes, and the number of terms: see [`rounding`].
fn apart(exact: &[[f64; 7]; 6], size: &[[f64; 7]; 6], terms: f64) -> [f32; 2] {
    const EPSILON: f64 = f32::EPSILON as f64;
    const UNSETTLED: [f32; 2] = [2.0 * LARGEST; 2];
    let Some((inverse, p)) = inverted(exact) else { return UNSETTLED };
    let diagonal: [f64; 6] = std::array::from_fn(|i| exact[i][i].abs().sqrt());
    let of_entry =
        |i: usize, j: usize| EPSILON * ((terms + 3.0) * size[i][j] + 24.0 * diagonal[i] * diagonal[j]);
    let of_side: [f64; 6] = std::array::from_fn(|i| {
        EPSILON * (terms + 3.0) * size[i][6] + (0..6).map(|j| of_entry(i, j) * p[j].abs()).sum::<f64>()
    });
    let row_sum = |i: usize| -> f64 {
        (0..6).map(|k| inverse[i][k].abs() * (0..6).map(|j| of_entry(k, j)).sum::<f64>()).sum()
    };
    let rho = (0..6).map(row_sum).fold(0.0, f64::max);
    if !(rho <= 0.5) {
        return UNSETTLED;
    }
    [0, 1].map(|i| {
        let bound = (0..6).map(|k| inverse[i][k].abs() * of_side[k]).sum::<f64>() / (1.0 - rho);
        let bound = bound + 4.0 * EPSILON * p[i].abs();
        let settled = p[i].abs() + bound <= f64::from(LARGEST);
        if settled { bound as f32 } else { 2.0 * LARGEST }
    })
}

/// The inverse and the solution of the six equations; `None` where elimination meets a pivot that is not above zero.
fn inverted(rows: &[[f64; 7]; 6]) -> Option<([[f64; 6]; 6], [f64; 6])> {
    let mut work: [[f64; 13]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|j| if j < 7 { rows[i][j] } else { f64::from(u8::from(j - 7 == i)) })
    });
    for pivot in 0..6 {
        let of = work[pivot];
        if !(of[pivot] > 0.0 && of[pivot].is_finite()) {
            return None;
        }
        for (i, row) in work.iter_mut().enumerate() {
            let factor = if i == pivot { 1.0 - 1.0 / of[pivot] } else { row[pivot] / of[pivot] };
            for (value, of) in row.iter_mut().zip(of) {
                *value -= factor * of;
            }
        }
    }
    Some((work.map(|row| std::array::from_fn(|j| row[7 + j])), work.map(|row| row[6])))
}

/// Equations of [`solve`]'s cases, averaged along columns.
fn cases(size: Size) -> Vec<Case> {
    let window = tables::window_from(&tables::window(13, true), 6);
    let (width, height, radius, step) = (size.width, size.height, 6, 1.0 / 6.0);
    let of_columns = affine_columns::Params { width, height, radius, step };
    let columns_of = |equations: Vec<f32>| {
        let mut columns = vec![0.0; CHANNELS * size.stride() * size.height as usize];
        let inputs: &[&[f32]] = &[&equations, &window];
        (affine_columns::KERNEL.reference)(bytemuck::bytes_of(&of_columns), inputs, &mut [&mut columns]);
        columns
    };
    let case = |name: &str, equations: Vec<f32>, added: f32| Case {
        name: name.to_owned(),
        params: bytemuck::bytes_of(&Params { width, height, radius, step, regular: 1e-3, added }).to_vec(),
        inputs: vec![columns_of(equations), window.clone(), planes(size, 2, Fill::Textured, [-6.0, 6.0], 9)],
        outputs: vec![2 * size.stride() * size.height as usize],
        extent: size,
    };
    let textured = || solve::equations(size, Fill::Textured);
    let scaled = |factor: f32| textured().iter().map(|value| factor * value).collect::<Vec<_>>();
    vec![
        case("textured", textured(), 0.0),
        case("added", textured(), 1.0),
        case("flat", solve::equations(size, Fill::Flat), 1.0),
        case("weak", scaled(1e-3), 0.0),
        case("overflowing", scaled(1e25), 1.0),
        case("edges", solve::edges(size, 1e-3), 0.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations of an affine motion give that motion, up to the border, where a window has only a part of its pixels.
    #[test]
    fn an_affine_motion_is_found_exactly() {
        let size = Size::new(41, 33);
        let stride = size.stride();
        let motion = |x: f32, y: f32| [1.0 + 0.03 * x - 0.02 * y, -0.5 + 0.01 * x + 0.04 * y];
        let mut equations = solve::equations(size, Fill::Textured);
        for (y, rows) in equations.chunks_exact_mut(5 * stride).enumerate() {
            for x in 0..stride {
                let [u, v] = motion(x.min(40) as f32, y as f32);
                let [xx, xy, yy] = [0, 1, 2].map(|channel| rows[channel * stride + x]);
                rows[3 * stride + x] = xx * u + xy * v;
                rows[4 * stride + x] = xy * u + yy * v;
            }
        }
        let (width, height, radius, step) = (size.width, size.height, 6, 1.0 / 6.0);
        let window = tables::window_from(&tables::window(13, true), 6);
        let mut columns = vec![0.0; CHANNELS * stride * size.height as usize];
        let params = affine_columns::Params { width, height, radius, step };
        let inputs: &[&[f32]] = &[&equations, &window];
        (affine_columns::KERNEL.reference)(bytemuck::bytes_of(&params), inputs, &mut [&mut columns]);
        let mut flow = vec![0.0; 2 * stride * size.height as usize];
        let params = Params { width, height, radius, step, regular: 1e-6, added: 0.0 };
        reference(&params, &columns, &window, &flow.clone(), &mut flow);
        for y in 0..33 {
            for x in 0..41 {
                let expected = motion(x as f32, y as f32);
                for (channel, expected) in expected.into_iter().enumerate() {
                    let found = flow[(2 * y + channel) * stride + x];
                    assert!((found - expected).abs() <= 1e-4, "{x}, {y}: {found}, {expected}");
                }
            }
        }
    }
}
