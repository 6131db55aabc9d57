//! As [`super::solve`], with the displacement that solves the averaged equations added to the flow so far.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3, with equations in which
//! the flow so far is not carried: a step of Newton's method for each pixel, as that of Lucas and Kanade is (Bouguet,
//! Pyramidal implementation of the Lucas Kanade feature tracker, 2001).

use super::solve::{self, average, displacement, rounding_of};
use super::test_inputs::{Fill, planes};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` columns.
        radius: u32,
        /// What is added to the determinant to keep it off zero, above 0.
        regular: f32,
    }
}

impl Params {
    fn window(&self) -> solve::Params {
        solve::Params { width: self.width, height: self.height, radius: self.radius }
    }
}

kernel!(
    "solve_increment" + ["image", "window", "average", "solution"],
    reference(Params; columns, window, so_far) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 0.0, of_largest: 0.0,
        reason: "as in solve, and that of the sum",
    },
    rounding: rounding,
);

fn reference(p: &Params, columns: &[f32], window: &[f32], so_far: &[f32], flow: &mut [f32]) {
    let stride = Size::new(p.width, p.height).stride();
    average(&p.window(), columns, window, flow, 2, #[inline(always)] |y, averages, rows| {
        let width = p.width as usize;
        let (u, v) = rows.split_at_mut(stride);
        let (u, v) = (&mut u[..width], &mut v[..width]);
        let [u_0, v_0] = [0, 1].map(|channel| &so_far[(2 * y + channel) * stride..][..width]);
        let averages = averages.map(|average| &average[..width]);
        for x in 0..width {
            let [d_x, d_y] = displacement(averages.map(|average| average[x]), p.regular);
            u[x] = u_0[x] + d_x;
            v[x] = v_0[x] + d_y;
        }
    });
}

/// The largest difference that roundings may cause: that of [`solve`], and one rounding of the sum.
fn rounding(p: &Params, columns: &[f32], window: &[f32], so_far: &[f32], bound: &mut [f32]) {
    let mut flow = vec![0.0; bound.len()];
    reference(p, columns, window, so_far, &mut flow);
    rounding_of(&p.window(), p.regular, columns, window, bound);
    for (bound, flow) in bound.iter_mut().zip(flow) {
        *bound += f32::EPSILON * (flow.abs() + *bound);
    }
}

fn cases(size: Size) -> Vec<Case> {
    let all = [1e-3, 1e-6].map(|regular| {
        let cases = solve::cases(size);
        cases.into_iter().map(move |mut case| {
            let solve::Params { width, height, radius } = bytemuck::pod_read_unaligned(&case.params);
            case.params = bytemuck::bytes_of(&Params { width, height, radius, regular }).to_vec();
            case.inputs.push(planes(size, 2, Fill::Textured, [-6.0, 6.0], 9));
            Case { name: format!("{}, {regular:e} in the determinant", case.name), ..case }
        })
    });
    all.into_iter().flatten().collect()
}
