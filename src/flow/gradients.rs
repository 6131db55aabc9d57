//! Equations from image gradients, averaged over a window, and the confidence that follows from them.

use super::images::LevelImage;
use crate::frame::Size;
use crate::kernels::{confidence, gradient_equations, tables, warp, window_y};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers of the equations of a pair of images.
pub(super) struct Gradients {
    warped: BufId,
    shown: BufId,
    equations: BufId,
    /// The equations averaged along columns only.
    pub(super) columns: BufId,
    window_y: BufId,
    /// The window's weights along rows.
    pub(super) window_x: BufId,
    /// The window's radius in pixels.
    pub(super) radius: u32,
}

impl Gradients {
    /// Allocates the buffers for images up to this size and a window of this width in pixels.
    pub(super) fn new(bufs: &mut Bufs, size: Size, winsize: u32, gaussian: bool) -> Self {
        let window = tables::window(winsize, gaussian);
        let radius = window.len() / 2;
        let (plane, five) = (Shape::planar(size, 1), Shape::planar(size, 5));
        Self {
            warped: bufs.computed("warped", plane),
            shown: bufs.computed("visible", plane),
            equations: bufs.computed("gradient equations", five),
            columns: bufs.computed("averaged columns", five),
            window_y: bufs.constant("window, columns", tables::window_from(&window, radius)),
            window_x: bufs.constant("window, rows", tables::window_from(&window, radius.next_multiple_of(4))),
            radius: radius as u32,
        }
    }

    /// The steps of the equations with the second image warped by a flow, averaged along columns, in `columns`.
    /// `residual` is that of [`gradient_equations::Params`].
    pub(super) fn steps(
        &self,
        steps: &mut Vec<Step>,
        label: &str,
        size: Size,
        [first, second]: [LevelImage; 2],
        flow: BufId,
        residual: u32,
    ) {
        let (width, height) = (size.width, size.height);
        let (plane, five) = (Shape::planar(size, 1), Shape::planar(size, 5));
        steps.push(Step::new(
            &warp::KERNEL,
            label,
            warp::Params { width, height },
            &[second.gray, second.certainty, flow],
            &[(self.warped, plane), (self.shown, plane)],
        ));
        steps.push(Step::new(
            &gradient_equations::KERNEL,
            label,
            gradient_equations::Params { width, height, residual },
            &[first.gray, first.certainty, self.warped, self.shown, flow],
            &[(self.equations, five)],
        ));
        steps.push(Step::new(
            &window_y::KERNEL,
            label,
            window_y::Params { width, height, radius: self.radius },
            &[self.equations, self.window_y],
            &[(self.columns, five)],
        ));
    }

    /// The steps of the confidence of a flow.
    pub(super) fn confidence(
        &self,
        steps: &mut Vec<Step>,
        size: Size,
        pair: [LevelImage; 2],
        flow: BufId,
        plane: BufId,
    ) {
        self.steps(steps, "confidence", size, pair, flow, 1);
        steps.push(Step::new(
            &confidence::KERNEL,
            "confidence",
            confidence::Params { width: size.width, height: size.height, radius: self.radius },
            &[self.columns, self.window_x],
            &[(plane, Shape::planar(size, 1))],
        ));
    }
}
