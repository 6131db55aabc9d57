//! Copies an expansion and its certainty, so that the next pair finds them after the slot has been filled anew.
//!
//! The cross term and the certainty share a buffer, all rows of the one and then all rows of the other, because
//! [`super::older_equations`] may bind no more than eight.

use super::test_inputs::{Fill, cases as each_fill, planes, quads};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    }
}

kernel!(
    "keep_expansion" + [],
    reference(Params; quad, cross_term, certainty) -> (kept_quad, kept_rest),
    cases: cases,
    tolerance: Tolerance { absolute: 0.0, relative: 0.0, of_largest: 0.0, reason: "a copy" },
);

fn reference(
    p: &Params,
    quad: &[f32],
    cross_term: &[f32],
    certainty: &[f32],
    kept_quad: &mut [f32],
    kept_rest: &mut [f32],
) {
    let len = Size::new(p.width, p.height).stride() * p.height as usize;
    let (kept_cross_term, kept_certainty) = kept_rest[..2 * len].split_at_mut(len);
    rayon::join(
        || kept_quad[..4 * len].copy_from_slice(&quad[..4 * len]),
        || {
            kept_cross_term.copy_from_slice(&cross_term[..len]);
            kept_certainty.copy_from_slice(&certainty[..len]);
        },
    );
}

fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height };
    let rows = [4 * size.stride(), 2 * size.stride()];
    each_fill(Fill::ALL, bytemuck::bytes_of(&params), &rows, size, |fill| {
        let ranges = [[-20.0, 20.0], [-20.0, 20.0], [-4.0, 4.0], [-4.0, 4.0]];
        vec![
            quads(size, fill, ranges, 1),
            planes(size, 1, fill, [-4.0, 4.0], 2),
            planes(size, 1, fill, [0.0, 1.0], 3),
        ]
    })
}
