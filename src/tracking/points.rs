//! Points followed from each frame to the next.

use super::{TrackParameters, plan};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::frame::{Frame, PixelFormat, Size};
use crate::plan::Value;
use crate::runner::Runner;

/// A point in the current frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPoint {
    /// The column, in pixels; of a lost point the last place of the search.
    pub x: f32,
    /// The row, in pixels.
    pub y: f32,
    /// Whether it was found (OpenCV's `status`). A found point's window meets the frame, the point itself may lie outside.
    pub found: bool,
    /// The mean absolute difference of the two windows, in gray levels (OpenCV's `err`); 0 if it was not found.
    pub error: f32,
    /// The distance in pixels from the point that the search back from here finds; `None` without a search back, and if it
    /// finds nothing.
    pub forward_backward_px: Option<f32>,
}

/// Follows given points from each frame to the next.
pub struct PointTracker {
    runner: Runner,
    capacity: usize,
    frames: u64,
    /// The inputs, as they are given to the plan.
    points: Vec<f32>,
    initial: Vec<f32>,
    tracked: Vec<TrackedPoint>,
}

impl PointTracker {
    /// Allocates the buffers for frames of this size and format and up to `capacity` points. With `backward` each point
    /// that is found is followed back.
    ///
    /// # Errors
    /// As [`plan`], and as [`Runner::new`].
    pub fn new(
        backend: &Backend,
        size: Size,
        format: PixelFormat,
        parameters: &TrackParameters,
        capacity: usize,
        backward: bool,
    ) -> Result<Self> {
        let runner = Runner::new(backend, plan(size, format, parameters, capacity, backward)?)?;
        Ok(Self { runner, capacity, frames: 0, points: Vec::new(), initial: Vec::new(), tracked: Vec::new() })
    }

    /// Follows points of the previous frame, `[x, y]` in pixels, into this one. `initial` are the places where their
    /// searches begin (OpenCV's `OPTFLOW_USE_INITIAL_FLOW`); without them a search begins at the point itself. The result
    /// has the order of the points. The first frame takes no points.
    ///
    /// # Errors
    /// [`Error::Parameter`] for more points than the capacity, a coordinate that is not finite, points of the first frame,
    /// or another number of initial places than of points; as [`Runner::frame`].
    pub fn track(
        &mut self,
        frame: &Frame<'_>,
        points: &[[f32; 2]],
        initial: Option<&[[f32; 2]]>,
    ) -> Result<&[TrackedPoint]> {
        if self.frames == 0 && !points.is_empty() {
            return Err(Error::parameter("points", points.len(), "none in the first frame"));
        }
        if points.len() > self.capacity {
            let expected = format_args!("at most {}", self.capacity);
            return Err(Error::parameter("number of points", points.len(), expected));
        }
        let initial = initial.unwrap_or(points);
        if initial.len() != points.len() {
            return Err(Error::parameter("number of initial places", initial.len(), points.len()));
        }
        let (capacity, parity) = (self.capacity, (self.frames % 2) as usize);
        pack("points", points, capacity, &mut self.points)?;
        pack("initial", initial, capacity, &mut self.initial)?;
        let given = [
            ("frame", Some(Value::Frame(frame))),
            ("points", Some(Value::Raw(&self.points))),
            ("initial", Some(Value::Raw(&self.initial))),
        ];
        let outputs = self.runner.frame(parity, self.frames > 0, &given)?;
        self.frames += 1;
        self.tracked.clear();
        let Some(tracked) = outputs.raw("tracked") else { unreachable!("the plan has this output") };
        let returned = outputs.raw("returned").map(|values| values.as_chunks::<4>().0);
        for (i, (point, [x, y, status, error])) in points.iter().zip(tracked.as_chunks::<4>().0).enumerate() {
            let back = returned.map(|returned| returned[i]).filter(|[_, _, status, _]| *status > 0.0);
            self.tracked.push(TrackedPoint {
                x: *x,
                y: *y,
                found: *status > 0.0,
                error: *error,
                forward_backward_px: back.map(|[x, y, ..]| (x - point[0]).hypot(y - point[1])),
            });
        }
        Ok(&self.tracked)
    }

    /// Forgets the previous frame: the next one is the first.
    pub fn reset(&mut self) {
        self.frames = 0;
    }
}

/// Points in the layout of the plan: x, y, 1 and 0, and zeros for those that are absent.
fn pack(name: &'static str, points: &[[f32; 2]], capacity: usize, values: &mut Vec<f32>) -> Result<()> {
    if let Some((i, [x, y])) =
        points.iter().enumerate().find(|(_, point)| !point.iter().all(|c| c.is_finite()))
    {
        return Err(Error::parameter(name, format_args!("({x}, {y}) at index {i}"), "finite coordinates"));
    }
    values.clear();
    values.extend(points.iter().flat_map(|[x, y]| [*x, *y, 1.0, 0.0]));
    values.resize(4 * capacity, 0.0);
    Ok(())
}
