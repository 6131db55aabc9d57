//! The plan from a frame to the sectors of the view.

use super::config::{Derotation, Sphere};
use super::grid::{Cells, Grid};
use super::motion::MOTION_LEN;
use crate::camera::{Camera, Lens};
use crate::error::{Error, Result};
use crate::flow::{Farneback, Parts, gray_step};
use crate::frame::{PixelFormat, Plane, Size};
use crate::kernels::{cells, lens_map, looming, luma, prime, remap, sectors, tangent, trust};
use crate::plan::{BufId, Bufs, Plan, Shape, Step};

/// What there is to look through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye<'a> {
    /// The camera that takes the frames.
    pub(crate) raw: &'a Camera,
    /// The pinhole whose pictures the flow is computed of.
    pub(crate) ideal: &'a Camera,
    /// How far each of the frame's pixels is to be trusted.
    pub(crate) mask: Option<&'a Plane>,
    /// Whether the camera's turn is known.
    pub(crate) gyro: bool,
}

/// Fields that are read beside the sectors, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fields {
    /// Nearness rate, divergence, error and trust of each cell.
    pub looming: bool,
    /// Trust, place and rate of each cell.
    pub cells: bool,
    /// The flow on the view sphere of each pixel.
    pub tangent: bool,
}

/// Where the pictures come from, in the ideal camera's geometry.
struct Front<'a> {
    eye: Eye<'a>,
    frame: BufId,
    /// The frames' brightness, by parity; one buffer where the frame before is not looked at again.
    raw: [BufId; 2],
    /// The picture that is expanded.
    gray: BufId,
    /// How far the ideal camera's pixels can be trusted.
    certainty: BufId,
    /// Where each pixel is read; none where the raw frame is the ideal picture.
    map: Option<Map>,
    /// The same for the frame before, as the turned camera would have seen it.
    turned: Option<Map>,
    mask: Option<BufId>,
    /// No turn.
    still: BufId,
    lens: lens_map::Params,
}

/// A resampling.
#[derive(Clone, Copy)]
struct Map {
    places: BufId,
    certainty: BufId,
}

impl<'a> Front<'a> {
    fn new(bufs: &mut Bufs, eye: Eye<'a>, view: &Sphere, format: PixelFormat) -> Self {
        let (raw, ideal) = (eye.raw.size, eye.ideal.size);
        let lens = lens_map::Params::new(eye.ideal, eye.raw).with_margin(view.margin_px as f32);
        let turns = eye.gyro && view.derotation == Derotation::Before;
        let plain = eye.raw == eye.ideal && eye.raw.lens == Lens::NONE && eye.mask.is_none();
        let map = |bufs: &mut Bufs, name: &str| Map {
            places: bufs.computed(format!("{name} map"), Shape::planar(ideal, 2)),
            certainty: bufs.computed(format!("{name} certainty"), Shape::planar(ideal, 1)),
        };
        let first = bufs.computed("brightness", Shape::planar(raw, 1));
        let second =
            if turns { bufs.computed("brightness of odd frames", Shape::planar(raw, 1)) } else { first };
        let turned = turns.then(|| map(bufs, "turned"));
        let undistort = (!plain).then(|| map(bufs, "undistortion"));
        Self {
            eye,
            frame: bufs.input("frame", luma::row_words(raw, format) * raw.height as usize),
            raw: [first, second],
            gray: if plain && !turns { first } else { bufs.computed("gray", Shape::planar(ideal, 1)) },
            certainty: match undistort {
                Some(map) => map.certainty,
                None => bufs.constant("equal certainty", vec![1.0; Shape::planar(ideal, 1).len()]),
            },
            mask: (undistort.is_some() || turns).then(|| {
                let mask = eye.mask.map(padded).unwrap_or_else(|| vec![1.0; Shape::planar(raw, 1).len()]);
                bufs.constant("mask", mask)
            }),
            map: undistort,
            turned,
            still: bufs.constant("no turn", vec![0.0; MOTION_LEN]),
            lens: match eye.mask {
                Some(_) => lens,
                None => lens.without_mask(),
            },
        }
    }

    /// What is computed once.
    fn setup(&self) -> Vec<Step> {
        self.map.iter().flat_map(|map| self.make(*map, self.still, "undistortion")).collect()
    }

    fn make(&self, map: Map, motion: BufId, label: &str) -> Option<Step> {
        let ideal = self.eye.ideal.size;
        Some(Step::new(
            &lens_map::KERNEL,
            label,
            self.lens,
            &[motion, self.mask?],
            &[(map.places, Shape::planar(ideal, 2)), (map.certainty, Shape::planar(ideal, 1))],
        ))
    }

    fn brightness(&self, parity: usize, format: PixelFormat) -> Step {
        gray_step(self.eye.raw.size, format, self.frame, self.raw[parity])
    }

    /// The picture of a frame through a map; the frame itself where there is none.
    fn picture(&self, steps: &mut Vec<Step>, parity: usize, map: Option<Map>, label: &str) -> BufId {
        let Some(map) = map else { return self.raw[parity] };
        let (raw, ideal) = (self.eye.raw.size, self.eye.ideal.size);
        steps.push(Step::new(
            &remap::KERNEL,
            label,
            remap::Params {
                width: ideal.width,
                height: ideal.height,
                in_width: raw.width,
                in_height: raw.height,
            },
            &[self.raw[parity], map.places],
            &[(self.gray, Shape::planar(ideal, 1))],
        ));
        self.gray
    }
}

/// A plane as a plan's buffer holds it.
fn padded(plane: &Plane) -> Vec<f32> {
    let (width, stride) = (plane.size.width as usize, plane.size.stride());
    let held = |value: f32| if value > 0.0 { value.min(1.0) } else { 0.0 };
    plane
        .data
        .chunks_exact(width)
        .flat_map(|row| (0..stride).map(move |x| held(row[x.min(width - 1)])))
        .collect()
}

/// The plan for frames of this format, and the cells and sectors it sums the flow up in.
///
/// # Errors
/// [`Error::Parameter`] for a parameter that is out of range, [`Error::SizeMismatch`] for a mask of another size.
pub(crate) fn plan(
    flow: &Farneback,
    view: &Sphere,
    eye: Eye<'_>,
    format: PixelFormat,
    fields: Fields,
) -> Result<(Plan, Cells, Grid)> {
    view.validate()?;
    let primed = eye.gyro && view.derotation == Derotation::Primed;
    let flow = Farneback { initial_flow: primed, confidence: false, ..flow.clone() };
    flow.validate()?;
    let size = eye.ideal.size;
    size.validate()?;
    eye.raw.size.validate()?;
    if let Some(mask) = eye.mask {
        mask.validate()?;
        if mask.size != eye.raw.size {
            return Err(Error::SizeMismatch {
                what: "mask".to_owned(),
                found: mask.size,
                expected: eye.raw.size,
            });
        }
    }
    let grid = Grid::over(eye.ideal, view.sectors)?;
    let cells = Cells::over(eye.ideal, view.cell);

    let mut bufs = Bufs::default();
    let front = Front::new(&mut bufs, eye, view, format);
    let motion = bufs.input("motion", MOTION_LEN);
    let found = bufs.computed("flow", Shape::planar(size, 2));
    let prime = primed.then(|| bufs.computed("flow of the turn", Shape::planar(size, 2)));
    let parts = Parts::new(&mut bufs, &flow, size);
    let back = Back::new(&mut bufs, view, eye.ideal, &cells, &grid, fields);

    let expand = |steps: &mut Vec<Step>, parity: usize, map: Option<Map>, slot: usize, label: &str| {
        let gray = front.picture(steps, parity, map, label);
        let certainty = map.map_or(front.certainty, |map| map.certainty);
        steps.extend(parts.expand(gray, flow.certainty.then_some(certainty), slot));
    };
    let ingest = [0, 1].map(|parity| {
        let mut steps = vec![front.brightness(parity, format)];
        if front.turned.is_none() {
            expand(&mut steps, parity, front.map, parity, "undistort");
        }
        steps
    });
    // The flow leads from the current frame back to the one before, so that it is known at the current frame's pixels.
    let pair = [0, 1].map(|parity| {
        let mut steps = Vec::new();
        let slots = match front.turned {
            None => [parity, 1 - parity],
            Some(turned) => {
                expand(&mut steps, parity, front.map, 0, "undistort");
                steps.extend(front.make(turned, motion, "turn"));
                expand(&mut steps, 1 - parity, Some(turned), 1, "undistort and turn");
                [0, 1]
            }
        };
        if let Some(prime) = prime {
            steps.push(prime_step(eye.ideal, motion, prime));
        }
        steps.extend(parts.flow(slots, prime.unwrap_or(found), found));
        let [first, second] = slots.map(|slot| parts.finest(slot));
        let expansions = [first.quad, first.cross_term, second.quad, second.cross_term];
        let certainty = [front.certainty, front.turned.map_or(front.certainty, |map| map.certainty)];
        let turn = if front.turned.is_some() { front.still } else { motion };
        back.steps(&mut steps, expansions, certainty, found, [turn, motion]);
        steps
    });
    let plan = Plan {
        size: eye.raw.size,
        flow_size: size,
        setup: front.setup(),
        ingest,
        pair,
        frame: front.frame,
        certainty: None,
        motion: Some(motion),
        flow: [found; 2],
        initial_flow: false,
        confidence: None,
        fields: back.fields(),
        bufs: bufs.finish(),
    };
    plan.validate()?;
    Ok((plan, cells, grid))
}

fn prime_step(ideal: &Camera, motion: BufId, flow: BufId) -> Step {
    Step::new(&prime::KERNEL, "turn", pinhole(ideal), &[motion], &[(flow, Shape::planar(ideal.size, 2))])
}

fn pinhole(camera: &Camera) -> tangent::Params {
    tangent::Params {
        width: camera.size.width,
        height: camera.size.height,
        focal: [camera.f_u as f32, camera.f_v as f32],
        centre: [camera.u_0 as f32, camera.v_0 as f32],
    }
}

/// From the flow to the sectors.
struct Back<'a> {
    ideal: &'a Camera,
    view: &'a Sphere,
    cells_at: &'a Cells,
    grid: [u32; 2],
    trust: BufId,
    cells: (BufId, Shape),
    looming: (BufId, Shape),
    sectors: (BufId, Shape),
    tangent: Option<(BufId, Shape)>,
    ranges: BufId,
    members: BufId,
    wanted: Fields,
}

impl<'a> Back<'a> {
    fn new(
        bufs: &mut Bufs,
        view: &'a Sphere,
        ideal: &'a Camera,
        cells: &'a Cells,
        grid: &Grid,
        wanted: Fields,
    ) -> Self {
        let columns_rows = Size::new(grid.columns as u32, grid.rows as u32);
        let mut computed = |name: &str, shape: Shape| (bufs.computed(name, shape), shape);
        let (trust, _) = computed("trust", Shape::planar(cells.size, 1));
        let of_cells = computed("cells", Shape::planar(cells.size, 5));
        let looming = computed("looming", Shape::planar(cells.size, 4));
        let sectors = computed("sectors", Shape::planar(columns_rows, sectors::CHANNELS));
        let tangent = wanted.tangent.then(|| computed("tangent flow", Shape::planar(ideal.size, 3)));
        let [ranges, members] = grid.members(cells);
        Self {
            ideal,
            view,
            cells_at: cells,
            grid: view.sectors,
            trust,
            cells: of_cells,
            looming,
            sectors,
            tangent,
            ranges: bufs.constant("ranges of members", ranges),
            members: bufs.constant("members of sectors", members),
            wanted,
        }
    }

    fn fields(&self) -> Vec<(BufId, Shape)> {
        let when = |wanted: bool, field| wanted.then_some(field);
        let beside =
            [when(self.wanted.looming, self.looming), when(self.wanted.cells, self.cells), self.tangent];
        std::iter::once(self.sectors).chain(beside.into_iter().flatten()).collect()
    }

    /// `turn` is what the flow still holds of the camera's turn, `motion` what is known of the heading.
    fn steps(
        &self,
        steps: &mut Vec<Step>,
        expansions: [BufId; 4],
        certainty: [BufId; 2],
        flow: BufId,
        [turn, motion]: [BufId; 2],
    ) {
        let Size { width, height } = self.ideal.size;
        let Size { width: columns, height: rows } = self.cells_at.size;
        let Sphere { cell, step, window, .. } = *self.view;
        if let Some(tangent) = self.tangent {
            steps.push(Step::new(&tangent::KERNEL, "sphere", pinhole(self.ideal), &[flow, turn], &[tangent]));
        }
        let [quad_0, cross_0, quad_1, cross_1] = expansions;
        steps.push(Step::new(
            &trust::KERNEL,
            "sphere",
            trust::Params { columns, rows, width, height, cell, step },
            &[quad_0, cross_0, quad_1, cross_1, certainty[0], certainty[1], flow],
            &[(self.trust, Shape::planar(self.cells_at.size, 1))],
        ));
        let tangent::Params { focal, centre, .. } = pinhole(self.ideal);
        steps.push(Step::new(
            &cells::KERNEL,
            "sphere",
            cells::Params { columns, rows, width, height, cell, step, focal, centre },
            &[flow, turn, certainty[0], self.trust],
            &[self.cells],
        ));
        let [origin, pitch] = self.cells_at.origin_and_pitch().map(|pair| pair.map(|value| value as f32));
        steps.push(Step::new(
            &looming::KERNEL,
            "sphere",
            looming::Params {
                columns,
                rows,
                radius: window,
                inner: window / 2,
                pitch,
                origin,
                noise: (self.view.noise_px / self.ideal.f_u) as f32,
                least_trust: self.view.least_trust as f32,
            },
            &[self.cells.0, motion],
            &[self.looming],
        ));
        steps.push(Step::new(
            &sectors::KERNEL,
            "sphere",
            sectors::Params {
                columns: self.grid[0],
                rows: self.grid[1],
                cell_columns: columns,
                // A window is whole where all its cells are trusted; at half of that it still counts.
                least_trust: 0.5 * self.view.least_trust as f32,
                quantile: self.view.quantile as f32,
            },
            &[self.cells.0, self.looming.0, self.ranges, self.members],
            &[self.sectors],
        ));
    }
}
