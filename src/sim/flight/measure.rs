//! What a pipeline measures, held against the true flow of the same cells.

use glam::DMat3;

use super::sensor_model::SensorInput;
use super::true_sensor::true_flow;
use crate::camera::{Camera, Pose};
use crate::error::Result;
use crate::frame::{Plane, Size};
use crate::pipeline::Cue;
use crate::sim::{RayTable, Seen, Twist, query_rays};
use crate::sphere::{Sphere, model};

/// True times to contact at which the measured ones are judged, seconds: steering acts on these.
const JUDGED_S: [f64; 2] = [0.7, 4.0];

/// How far a frame's measured flow is from the true one; or a flight's, as medians over its frames.
///
/// A cell's truth is the mean over the samples that its measured flow is the mean of, each from what its ray meets and the
/// exact poses of the two frames; what the gyro gets wrong of the turn between them is part of the error. The sky stands
/// still, infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Median length by which the flow on the view sphere from one frame to the next, the camera's turn taken out, is off in
    /// the half of the trusted cells that is trusted more than the other: in pixels of the ideal picture's middle. None where
    /// there are no such cells.
    pub better_half_error_px: Option<f64>,
    /// The same in all trusted cells.
    pub trusted_error_px: Option<f64>,
    /// The share of cells that are trusted, by [`Sphere::least_confidence`] or more: 0 to 1.
    pub trusted: f64,
    /// Median relative error of the time to contact, in trusted cells whose true one is between 0.7 and 4 s; a cell that
    /// shows nothing coming nearer is infinitely wrong. None where there are no such cells.
    pub contact_error: Option<f64>,
    /// How many of these there are; of a flight, in all its frames together.
    pub contact_cells: usize,
}

/// The divergence of the flow on the view sphere in each cell, 1/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergences {
    /// As measured; NaN in cells around which too little is trusted.
    pub measured_hz: Plane,
    /// In truth: the mean over a cell.
    pub true_hz: Plane,
}

impl Measured {
    /// Medians over frames; none of no frames.
    pub(super) fn over(frames: &[Self]) -> Option<Self> {
        let of = |part: fn(&Self) -> Option<f64>| median(frames.iter().filter_map(part).collect());
        Some(Self {
            better_half_error_px: of(|frame| frame.better_half_error_px),
            trusted_error_px: of(|frame| frame.trusted_error_px),
            trusted: of(|frame| Some(frame.trusted))?,
            contact_error: of(|frame| frame.contact_error),
            contact_cells: frames.iter().map(|frame| frame.contact_cells).sum(),
        })
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Holds cues against the truth.
pub(super) struct Measure {
    /// Of the samples, or of all pixels where the samples of two cells are not evenly apart.
    rays: RayTable,
    /// Pixels from one ray to the next.
    apart: usize,
    cell: usize,
    step: usize,
    least_confidence: f64,
    focal_px: f64,
    divergences: Divergences,
    /// From where the picture that is shown was taken; none if it was not taken at all.
    shown: Option<Pose>,
    /// The same of the frame before.
    before: Option<Pose>,
}

/// Sums over the samples of a cell, then their means.
#[derive(Default)]
struct Truth {
    count: f64,
    /// In the plane at unit distance, as the measured one.
    flow: [f64; 2],
    nearness_per_m: f64,
    divergence_hz: f64,
}

impl Measure {
    pub(super) fn new(ideal: &Camera, cells: Size, view: &Sphere) -> Result<Self> {
        let apart = if view.cell.is_multiple_of(view.step) { view.step } else { 1 };
        let share = f64::from(apart);
        let sampled = Camera {
            size: Size::new(ideal.size.width.div_ceil(apart), ideal.size.height.div_ceil(apart)),
            f_u: ideal.f_u / share,
            f_v: ideal.f_v / share,
            u_0: ideal.u_0 / share,
            v_0: ideal.v_0 / share,
            lens: ideal.lens,
        };
        let unknown = Plane { size: cells, data: vec![f32::NAN; cells.pixels()] };
        Ok(Self {
            rays: RayTable::new(&sampled)?,
            apart: apart as usize,
            cell: view.cell as usize,
            step: view.step as usize,
            least_confidence: view.least_confidence,
            focal_px: ideal.f_u,
            divergences: Divergences { measured_hz: unknown.clone(), true_hz: unknown },
            shown: None,
            before: None,
        })
    }

    /// Says from where the picture was taken that the pipeline is shown next, if it was.
    pub(super) fn show(&mut self, pose: Option<Pose>) {
        self.shown = pose;
    }

    /// The divergences of the cue that was compared last.
    pub(super) fn divergences(&self) -> &Divergences {
        &self.divergences
    }

    /// Compares what the pipeline says of the picture that it was shown. None if it says nothing.
    pub(super) fn compare(&mut self, cue: &Cue<'_>, at: &SensorInput<'_>) -> Option<Measured> {
        let before = std::mem::replace(&mut self.before, self.shown)?;
        let (Some(looming), Some(cells), Some(interval_s), None) =
            (cue.looming, cue.cells, cue.interval_s, cue.invalid)
        else {
            return None;
        };
        let pose = self.shown?;
        let prev_from_cur = before.world_from_camera.transpose() * pose.world_from_camera;
        let velocity_m_s = pose.world_from_camera.transpose() * at.velocity_world_m_s;
        let motion = Twist { velocity_m_s, rate_rad_s: glam::DVec3::ZERO };
        let seen = query_rays(at.world, &self.rays, &pose);
        let size = self.divergences.true_hz.size;
        let (columns, stride) = (size.width as usize, size.stride());
        let (mut trusted, mut contacts) = (Vec::new(), Vec::new());
        for i in 0..size.pixels() {
            let cell = [i % columns, i / columns];
            let value = |field: &[f32], channels: usize, channel: usize| {
                f64::from(field[(channels * cell[1] + channel) * stride + cell[0]])
            };
            let truth = self.truth(cell, &seen, [&before, &pose], &prev_from_cur, &motion);
            // As the sectors take them.
            let is_known = value(looming, 4, 3) >= 0.5 * self.least_confidence;
            let divergence_hz = if is_known { value(looming, 4, 1) / interval_s } else { f64::NAN };
            self.divergences.measured_hz.data[i] = divergence_hz as f32;
            self.divergences.true_hz.data[i] = truth.divergence_hz as f32;
            let confidence = value(cells, 5, 0);
            if !(confidence >= self.least_confidence) {
                continue;
            }
            let place = [1, 2].map(|channel| value(cells, 5, channel));
            let off = [0, 1].map(|axis| value(cells, 5, 3 + axis) - truth.flow[axis]);
            trusted.push((confidence, self.focal_px * model::from_plane(place, off).length()));
            let true_s = (truth.nearness_per_m * velocity_m_s.length()).recip();
            if is_known && (JUDGED_S[0]..=JUDGED_S[1]).contains(&true_s) {
                let rate_hz = value(looming, 4, 0) / interval_s;
                // The rate is that half-way between the frames.
                let contact_s =
                    if rate_hz > 0.0 { (rate_hz.recip() - 0.5 * interval_s).max(0.0) } else { f64::INFINITY };
                contacts.push((contact_s / true_s - 1.0).abs());
            }
        }
        trusted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let errors_px: Vec<f64> = trusted.into_iter().map(|(_, error_px)| error_px).collect();
        Some(Measured {
            better_half_error_px: median(errors_px[..errors_px.len().div_ceil(2)].to_vec()),
            trusted: errors_px.len() as f64 / size.pixels() as f64,
            trusted_error_px: median(errors_px),
            contact_cells: contacts.len(),
            contact_error: median(contacts),
        })
    }

    /// The means over a cell's samples.
    fn truth(
        &self,
        cell: [usize; 2],
        seen: &[Option<Seen>],
        poses: [&Pose; 2],
        prev_from_cur: &DMat3,
        motion: &Twist,
    ) -> Truth {
        let Size { width, height } = self.rays.size();
        let along = |axis: usize, side: u32| {
            let pixels = (0..self.cell).step_by(self.step).map(move |pixel| cell[axis] * self.cell + pixel);
            pixels.map(|pixel| pixel / self.apart).filter(move |ray| *ray < side as usize)
        };
        let mut truth = Truth::default();
        for y in along(1, height) {
            for seen in along(0, width).filter_map(|x| seen[y * width as usize + x]) {
                let (bearing, flow) = true_flow(seen.bearing, seen.nearness_per_m, poses, prev_from_cur);
                let [x, y] = model::to_plane(bearing, flow);
                truth.count += 1.0;
                truth.flow = [truth.flow[0] + x, truth.flow[1] + y];
                truth.nearness_per_m += seen.nearness_per_m;
                truth.divergence_hz += seen.divergence_per_s(motion);
            }
        }
        Truth {
            flow: truth.flow.map(|sum| sum / truth.count),
            nearness_per_m: truth.nearness_per_m / truth.count,
            divergence_hz: truth.divergence_hz / truth.count,
            ..truth
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::time::Duration;

    use glam::DVec3;

    use super::*;
    use crate::camera::{FRD_FROM_CAMERA, Lens, world_from_body};
    use crate::frame::FlowField;
    use crate::kernels::cells::{KERNEL, Params};
    use crate::sim::{CourseKind, displacement};
    use crate::sphere::{Grid, Heading, Sectors};

    const SIZE: Size = Size::new(96, 72);
    fn view() -> Sphere {
        Sphere { cell: 4, step: 2, sectors: [8, 6], ..Sphere::default() }
    }

    fn pose(forward_m: f64) -> Pose {
        Pose {
            position_world: DVec3::new(30.0 + forward_m, 1.0, -10.0),
            world_from_camera: world_from_body(0.1, -0.05, 0.2 + 0.1 * forward_m) * FRD_FROM_CAMERA,
        }
    }

    /// The pixels' true displacement, a field of pictures, made into cells by the pipeline's own kernel, is no different from
    /// the flow of bearings.
    #[test]
    fn true_pixels_are_measured_as_true() {
        let world = "city".parse::<CourseKind>().unwrap().course(3).unwrap().world;
        let ideal = Camera { size: SIZE, f_u: 44.0, f_v: 46.0, u_0: 47.0, v_0: 36.0, lens: Lens::NONE };
        let [earlier, before, pose] = [-0.04, 0.0, 0.4].map(pose);
        let flow = displacement(&world, &ideal, &RayTable::new(&ideal).unwrap(), &pose, &before).unwrap();
        let plane = |component: usize, row: usize| {
            flow.data[96 * row..96 * (row + 1)].iter().map(move |flow| flow[component])
        };
        let pixels: Vec<f32> = (0..72).flat_map(|row| plane(0, row).chain(plane(1, row))).collect();
        let known =
            flow.data.iter().map(|flow| f32::from(u8::from(FlowField::is_known(*flow)))).collect::<Vec<_>>();
        let turn = before.world_from_camera.transpose() * pose.world_from_camera;
        let motion = crate::sphere::Motion { prev_from_cur: turn, heading: Heading::UNKNOWN }.values();
        let (columns, rows) = (24, 18);
        let params = Params {
            columns,
            rows,
            width: 96,
            height: 72,
            cell: 4,
            step: 2,
            focal: [44.0, 46.0],
            centre: [47.0, 36.0],
        };
        let confidence = vec![1.0; 24 * 18];
        let mut cells = vec![0.0; 5 * 24 * 18];
        (KERNEL.reference)(
            bytemuck::bytes_of(&params),
            &[&pixels, &motion, &known, &confidence],
            &mut [&mut cells],
        );
        let mut measure = Measure::new(&ideal, Size::new(columns, rows), &view()).unwrap();
        // Of which nothing is known.
        let looming = vec![0.0; 4 * 24 * 18];
        let sectors = Sectors::unknown(Grid::over(&ideal, view().sectors).unwrap());
        let cue = Cue {
            frame: 1,
            time_s: 1.0,
            interval_s: Some(1.0 / 30.0),
            invalid: None,
            prev_from_cur: Some(turn),
            residual_rotation_rad_s: None,
            heading: Heading::UNKNOWN,
            sectors: &sectors,
            threat: None,
            flow: None,
            looming: Some(&looming),
            cells: Some(&cells),
            spherical_flow: None,
            latency: Duration::ZERO,
        };
        let input = |pose: Pose| SensorInput {
            world: &world,
            pose,
            velocity_world_m_s: DVec3::X * 12.0,
            heading: None,
            frame: 1,
            time_s: 1.0,
        };
        measure.show(Some(before));
        assert_eq!(measure.compare(&cue, &input(before)), None);
        measure.show(Some(pose));
        let found = measure.compare(&cue, &input(pose)).unwrap();
        // The displacement is an f32 of a few pixels, and the kernel computes in f32.
        assert!(found.trusted > 0.9 && !(found.trusted_error_px.unwrap() > 1e-4), "{found:?}");
        assert_eq!((found.contact_cells, found.contact_error), (0, None));
        let Divergences { measured_hz, true_hz } = measure.divergences();
        assert!(measured_hz.data.iter().all(|value| value.is_nan()));
        assert!(true_hz.data.iter().all(|value| value.is_finite()));
        // A pose that is wrong by a tenth of the way shows.
        measure.show(Some(earlier));
        measure.compare(&cue, &input(before));
        measure.show(Some(pose));
        let wrong = measure.compare(&cue, &input(pose)).unwrap();
        assert!(wrong.trusted_error_px.unwrap() > 2e-3, "{wrong:?}");
    }

    fn frame(error_px: f64, contact: Option<f64>) -> Measured {
        Measured {
            better_half_error_px: Some(error_px),
            trusted_error_px: None,
            trusted: error_px,
            contact_error: contact,
            contact_cells: 3,
        }
    }

    #[test]
    fn a_flight_is_the_median_of_its_frames() {
        assert_eq!(Measured::over(&[]), None);
        let frames = [frame(0.3, None), frame(0.1, Some(f64::INFINITY)), frame(0.2, Some(0.05))];
        let expected = Measured { contact_error: Some(f64::INFINITY), contact_cells: 9, ..frame(0.2, None) };
        assert_eq!(Measured::over(&frames), Some(expected));
    }
}
