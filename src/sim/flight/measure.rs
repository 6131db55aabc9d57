//! Compares a pipeline's cues with the true flow of the same cells.

use super::accuracy::{Divergences, Measured};
use super::cell_truth::CellRays;
use super::perception::SensorInput;
use crate::camera::{Camera, Pose};
use crate::error::Result;
use crate::frame::{Plane, Size};
use crate::kernels::cells::CHANNELS;
use crate::pipeline::Cue;
use crate::quantile::median;
use crate::sim::{Twist, query_rays};
use crate::sphere::{Sphere, model};

/// The true times to contact for which the measured ones are compared, seconds: those on which steering acts.
const JUDGED_S: [f64; 2] = [0.7, 4.0];

/// Compares cues with the truth.
pub(super) struct Measure {
    rays: CellRays,
    least_confidence: f64,
    focal_px: f64,
    divergences: Divergences,
    /// The pose at which the shown image was rendered; `None` for an image that was not rendered.
    shown: Option<Pose>,
    /// The previous frame's pose.
    before: Option<Pose>,
}

impl Measure {
    pub(super) fn new(ideal: &Camera, cells: Size, view: &Sphere) -> Result<Self> {
        let unknown = Plane { size: cells, data: vec![f32::NAN; cells.pixels()] };
        Ok(Self {
            rays: CellRays::new(ideal, view)?,
            least_confidence: view.least_confidence,
            focal_px: ideal.f_u,
            divergences: Divergences { measured_hz: unknown.clone(), true_hz: unknown },
            shown: None,
            before: None,
        })
    }

    /// Records the pose at which the next image was rendered, if it was.
    pub(super) fn show(&mut self, pose: Option<Pose>) {
        self.shown = pose;
    }

    /// The divergences of the last cue compared.
    pub(super) fn divergences(&self) -> &Divergences {
        &self.divergences
    }

    /// Compares the cue of the image shown last; `None` if the cue is invalid, or if either frame has no pose.
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
        let seen = query_rays(at.world, self.rays.table(), &pose);
        let size = self.divergences.true_hz.size;
        let (columns, stride) = (size.width as usize, size.stride());
        let (mut trusted, mut contacts) = (Vec::new(), Vec::new());
        for i in 0..size.pixels() {
            let cell = [i % columns, i / columns];
            let value = |field: &[f32], channels: usize, channel: usize| {
                f64::from(field[(channels * cell[1] + channel) * stride + cell[0]])
            };
            let truth = self.rays.truth(cell, &seen, [&before, &pose], &prev_from_cur, &motion);
            // The same condition as the sectors use.
            let is_known = value(looming, 4, 3) >= 0.5 * self.least_confidence;
            let divergence_hz = if is_known { value(looming, 4, 1) / interval_s } else { f64::NAN };
            self.divergences.measured_hz.data[i] = divergence_hz as f32;
            self.divergences.true_hz.data[i] = truth.divergence_hz as f32;
            let confidence = value(cells, CHANNELS, 5);
            if !(confidence >= self.least_confidence) {
                continue;
            }
            let place = [1, 2].map(|channel| value(cells, CHANNELS, channel));
            let off = [0, 1].map(|axis| value(cells, CHANNELS, 3 + axis) - truth.flow[axis]);
            trusted.push((confidence, self.focal_px * model::from_plane(place, off).length()));
            let true_s = (truth.nearness_per_m * velocity_m_s.length()).recip();
            if is_known && (JUDGED_S[0]..=JUDGED_S[1]).contains(&true_s) {
                let rate_hz = value(looming, 4, 0) / interval_s;
                // The rate is that of the moment half-way between the frames.
                let contact_s =
                    if rate_hz > 0.0 { (rate_hz.recip() - 0.5 * interval_s).max(0.0) } else { f64::INFINITY };
                contacts.push((contact_s / true_s - 1.0).abs());
            }
        }
        trusted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let errors_px: Vec<f64> = trusted.into_iter().map(|(_, error_px)| error_px).collect();
        Some(Measured {
            better_half_error_px: median(errors_px[..errors_px.len().div_ceil(2)].iter().copied()),
            trusted: errors_px.len() as f64 / size.pixels() as f64,
            trusted_error_px: median(errors_px),
            contact_cells: contacts.len(),
            contact_error: median(contacts),
        })
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
    use crate::sim::{CourseKind, RayTable, displacement};
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

    /// The true displacement in pixels, aggregated into cells by the pipeline's own kernel, equals the true flow of the
    /// bearings.
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
        let confidence = vec![1.0; 2 * 24 * 18];
        let mut cells = vec![0.0; CHANNELS * 24 * 18];
        (KERNEL.reference)(
            bytemuck::bytes_of(&params),
            &[&pixels, &motion, &known, &confidence],
            &mut [&mut cells],
        );
        let mut measure = Measure::new(&ideal, Size::new(columns, rows), &view()).unwrap();
        // Nothing is known of the looming.
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
            climb: None,
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
        // A pose that is wrong by a tenth of the distance moved is noticed.
        measure.show(Some(earlier));
        measure.compare(&cue, &input(before));
        measure.show(Some(pose));
        let wrong = measure.compare(&cue, &input(pose)).unwrap();
        assert!(wrong.trusted_error_px.unwrap() > 2e-3, "{wrong:?}");
    }
}
