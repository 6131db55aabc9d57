//! Adds to a pair's equations those of the frame before it.
//!
//! With a displacement d that stays the same from frame to frame, a pixel of the first frame was at x − d in the frame before
//! it; of a flow that leads back, the pixel of the newest frame was at x + 2 d two frames ago. The equations are those of
//! [`super::weighted_robust_equations`] with t d in place of d, where t is −1 or 2: the place is x + t d, and the Hessian is
//! multiplied by t (Farnebäck, SCIA 2003, for a pair; Nagel, Extending the "oriented smoothness constraint" into the temporal
//! domain, ECCV 1990, for more frames than two). A place outside the older frame, and one without certainty, adds nothing;
//! so does a frame that is all zeros, certainty included, which stands for none.

use super::expansion_pair::{ExpansionPair, fours, zero_unknown};
use super::parallel_rows::dimensions;
use super::robust_equations::{self, equations_of, inputs};
use super::test_inputs::{Fill, planes};
use super::weighted_robust_equations::LEAST_CERTAINTY;
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image, and the equations' form.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The share κ of its Hessian by which an expansion is continued to a place between pixels.
        kappa: f32,
        /// ζ²: what is added to the squared slope that divides an equation.
        floor: f32,
        /// ε², in square pixels, above 0.
        robust: f32,
        /// 1 to take OpenCV's weights off pixels near the border, or 0.
        border: f32,
        /// The time t of the older frame, in displacements from the first frame: −1 or 2.
        time: f32,
        /// The weight of its equations beside the pair's.
        weight: f32,
    }
}

kernel!(
    "older_equations" + ["equations", "model", "weighted_second", "slope_residual", "robust"],
    reference(
        Params; quad_0, cross_term_0, certainty_0, quad_1, rest_1, flow, pair
    ) -> (equations),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 4e-4,
        of_largest: 6e-5,
        reason: "as of the equations with certainty, and twice where the place is twice the displacement away, which is rounded \
                 as much again",
    },
);

#[allow(clippy::too_many_arguments, reason = "one for each buffer, as in the shader")]
fn reference(
    p: &Params,
    quad_0: &[f32],
    cross_term_0: &[f32],
    certainty_0: &[f32],
    quad_1: &[f32],
    rest_1: &[f32],
    flow: &[f32],
    of_pair: &[f32],
    equations: &mut [f32],
) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let (cross_term_1, certainty_1) = rest_1[..2 * stride * height].split_at(stride * height);
    let pair = ExpansionPair {
        quad_0: fours(quad_0),
        cross_term_0,
        quad_1: fours(quad_1),
        cross_term_1,
        certainty_1: Some(certainty_1),
        width,
        height,
        stride,
        kappa: p.kappa,
        time: p.time,
    };
    let own = robust_equations::Params {
        width: p.width,
        height: p.height,
        kappa: p.kappa,
        floor: p.floor,
        robust: p.robust,
        outside: 0.0,
        border: p.border,
    };
    pair.each_block(equations, flow, #[inline(always)] |model, stretch| {
        let mut channels = equations_of(model, stretch, &own, p.time);
        for (i, &certainty_0) in certainty_0[stretch.at..][..stretch.count].iter().enumerate() {
            let certainty = certainty_0 * model.certainty_1[i];
            let known = model.inside[i] > 0.0 && certainty > LEAST_CERTAINTY;
            for channel in &mut channels {
                channel[i] = if known { p.weight * certainty * channel[i] } else { 0.0 };
            }
        }
        zero_unknown(&mut channels);
        let (y, x0) = (stretch.at / stride, stretch.at % stride);
        for (c, channel) in channels.iter_mut().enumerate() {
            let row = &of_pair[(5 * y + c) * stride + x0..][..stretch.count];
            for (value, of_pair) in channel.iter_mut().zip(row) {
                *value += of_pair;
            }
        }
        channels
    });
}

/// Cases of a frame before the pair, of one two displacements back, and of none.
fn cases(size: Size) -> Vec<Case> {
    let all = [("forward", -1.0, 0.5), ("backward", 2.0, 1.0), ("none", -1.0, 0.0)].map(|(name, time, certainty)| {
        let params = Params {
            width: size.width,
            height: size.height,
            kappa: 0.3,
            floor: 0.25,
            robust: 0.01,
            border: if time < 0.0 { 1.0 } else { 0.0 },
            time,
            weight: 0.5,
        };
        let cases = inputs(size, bytemuck::bytes_of(&params), &[[0.0, 1.0]]);
        cases.into_iter().zip(Fill::ALL).map(move |(mut case, fill)| {
            // The cross term and the certainty share a buffer, and the pair's equations come last.
            let rest: Vec<f32> = case.inputs[5].iter().map(|own| own * certainty).collect();
            case.inputs[4].extend(rest);
            case.inputs.remove(5);
            case.inputs.push(planes(size, 5, *fill, [-40.0, 40.0], 9));
            Case { name: format!("{}, {name}", case.name), ..case }
        })
    });
    all.into_iter().flatten().collect()
}
