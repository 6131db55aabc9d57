//! The detector: its plan, and the selection of corners from the plan's outputs.

use super::{Corner, CornerParameters, CornerResponse, Select};
use crate::backend::Backend;
use crate::error::Result;
use crate::flow::gray_step;
use crate::frame::{Frame, PixelFormat, Plane, Size};
use crate::kernels::{block_sum, corner_response, local_maxima, row_maximum, structure_tensor};
use crate::plan::{Bufs, Fill, Plan, Port, PortKind, Shape, Step, Value};
use crate::runner::Runner;

/// The plan that computes a frame's corner response.
///
/// Inputs are `frame` and `mask`, a plane that is over 0 where corners may lie (everywhere if it is not given). Outputs are
/// `response`, a plane; `maxima`, a plane of the response at local maxima and 0 elsewhere; and `row_maximum`, four equal
/// values per row: the row's largest response where the mask is over 0, [`f32::MIN`] where it is nowhere.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for a parameter or size that is out of range.
pub fn plan(size: Size, format: PixelFormat, parameters: &CornerParameters) -> Result<Plan> {
    parameters.validate()?;
    size.validate()?;
    let Size { width, height } = size;
    let block = parameters.block_size;
    let (plane, three) = (Shape::planar(size, 1), Shape::planar(size, 3));
    let rows = Shape::planar(Size::new(1, height), 1);
    let mut bufs = Bufs::default();
    let frame_kind = PortKind::Frame { size, format };
    let plane_kind = PortKind::Plane { size, range: None };
    let frame = bufs.input("frame", frame_kind.len());
    let mask = bufs.input("mask", plane.len());
    let gray = bufs.computed("gray", plane);
    let tensor = bufs.computed("structure tensor", three);
    let columns = bufs.computed("structure tensor, columns summed", three);
    let response = bufs.computed("corner response", plane);
    let maxima = bufs.computed("local maxima", plane);
    let row_maximum = bufs.computed("row maximum", rows);
    // OpenCV's unit: Sobel's sums are four times a derivative over two pixels, and white is 1.
    let scale = (1.0 / (4.0 * f64::from(block) * 255.0)) as f32;
    let (harris, k) = match parameters.response {
        CornerResponse::MinEigenvalue => (0, 0.0),
        CornerResponse::Harris { k } => (1, k as f32),
    };
    let steps = vec![
        gray_step(size, format, frame, gray),
        Step::new(
            &structure_tensor::KERNEL,
            "corners",
            structure_tensor::Params { width, height, scale },
            &[gray],
            &[(tensor, three)],
        ),
        Step::new(
            &block_sum::KERNEL,
            "corners",
            block_sum::Params { width, height, block },
            &[tensor],
            &[(columns, three)],
        ),
        Step::new(
            &corner_response::KERNEL,
            "corners",
            corner_response::Params { width, height, block, harris, k },
            &[columns],
            &[(response, plane)],
        ),
        Step::new(
            &local_maxima::KERNEL,
            "corners",
            local_maxima::Params { width, height },
            &[response, mask],
            &[(maxima, plane)],
        ),
        Step::new(
            &row_maximum::KERNEL,
            "corners",
            row_maximum::Params { width, height },
            &[response, mask],
            &[(row_maximum, rows)],
        ),
    ];
    let inputs = vec![
        Port::new("frame", frame_kind, frame, Fill::Required),
        Port::new("mask", plane_kind, mask, Fill::Value(1.0)),
    ];
    let outputs = vec![
        Port::output("response", plane_kind, response),
        Port::output("maxima", plane_kind, maxima),
        Port::output("row_maximum", PortKind::Raw { len: rows.len() }, row_maximum),
    ];
    let plan = Plan::single(size, bufs.finish(), steps, inputs, outputs);
    plan.validate()?;
    Ok(plan)
}

/// Finds the corners of frames of one size and format.
pub struct CornerDetector {
    runner: Runner,
    parameters: CornerParameters,
}

impl CornerDetector {
    /// Allocates the buffers for frames of this size and format.
    ///
    /// # Errors
    /// As [`plan`], and as [`Runner::new`].
    pub fn new(
        backend: &Backend,
        size: Size,
        format: PixelFormat,
        parameters: &CornerParameters,
    ) -> Result<Self> {
        // The response itself stays on the device: only its maxima are read.
        let mut plan = plan(size, format, parameters)?;
        plan.outputs.retain(|port| port.name != "response");
        Ok(Self { runner: Runner::new(backend, plan)?, parameters: *parameters })
    }

    /// The corners of a frame, strongest first, where the mask is over 0 (everywhere without one). The border of one pixel
    /// has none.
    ///
    /// # Errors
    /// [`Error::PixelFormat`](crate::Error::PixelFormat) and [`Error::SizeMismatch`](crate::Error::SizeMismatch) for a frame
    /// or mask of another format or size; [`Error::DeviceLost`](crate::Error::DeviceLost) if the device was lost.
    pub fn detect(&mut self, frame: &Frame<'_>, mask: Option<&Plane>) -> Result<Vec<Corner>> {
        let limit = (self.parameters.max_corners > 0).then_some(self.parameters.max_corners);
        self.detect_beside(frame, mask, &[], limit)
    }

    /// The same, with corners that keep their distance from points, and another limit of their number.
    pub(crate) fn detect_beside(
        &mut self,
        frame: &Frame<'_>,
        mask: Option<&Plane>,
        occupied: &[[f32; 2]],
        limit: Option<usize>,
    ) -> Result<Vec<Corner>> {
        let given = [("frame", Some(Value::Frame(frame))), ("mask", mask.map(Value::Plane))];
        let outputs = self.runner.run(&given)?;
        let (Some(maxima), Some(rows)) = (outputs.plane("maxima"), outputs.raw("row_maximum")) else {
            unreachable!("the plan has these outputs");
        };
        let largest = rows.iter().copied().fold(f32::MIN, f32::max);
        Ok(Select { parameters: &self.parameters, occupied, limit }.corners(maxima, largest))
    }
}

/// The corners of a single frame. For more frames make one [`CornerDetector`].
///
/// # Errors
/// As [`CornerDetector::new`] and [`CornerDetector::detect`].
pub fn good_features(
    backend: &Backend,
    frame: &Frame<'_>,
    mask: Option<&Plane>,
    parameters: &CornerParameters,
) -> Result<Vec<Corner>> {
    CornerDetector::new(backend, frame.size(), frame.format(), parameters)?.detect(frame, mask)
}
