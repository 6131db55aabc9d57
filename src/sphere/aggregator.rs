//! Sectors of flow from other sources, aggregated as a plan aggregates its own.

use glam::{DMat3, DVec3};

use super::aggregate::{looming_params, sectors_params};
use super::{Cells, Grid, Heading, Motion, Sectors, Sphere, model};
use crate::camera::{Camera, Lens};
use crate::error::{Error, Result};
use crate::frame::Size;
use crate::kernels::cells::CHANNELS;
use crate::kernels::{looming, sectors};

/// Aggregates flow on the view sphere into sectors, on the CPU: true flow, or the flow of another estimator.
///
/// It runs the second half of a pipeline's plan, from the cells on, with the same kernels.
#[derive(Clone, Debug)]
pub struct SectorAggregator {
    cells: Cells,
    looming_params: looming::Params,
    sectors_params: sectors::Params,
    ranges: Vec<f32>,
    members: Vec<f32>,
    of_cells: Vec<f32>,
    looming: Vec<f32>,
    summed: Vec<f32>,
    sectors: Sectors,
}

/// The flow of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFlow {
    /// Its bearing, a unit vector in the camera's frame, half-way between the two frames.
    pub bearing: DVec3,
    /// The derotated motion of the bearing from the previous frame to the current one, in radians.
    pub flow_rad: DVec3,
    /// Its confidence, 0 to 1.
    pub confidence: f64,
}

impl SectorAggregator {
    /// Creates an aggregator for the view of a camera without a lens.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter that is out of range, or a camera with a lens.
    pub fn new(ideal: &Camera, view: &Sphere) -> Result<Self> {
        view.validate()?;
        ideal.validate()?;
        if ideal.lens != Lens::NONE {
            return Err(Error::parameter("ideal", "a camera with a lens", "one without"));
        }
        let cells = Cells::over(ideal, view.cell);
        let grid = Grid::over(ideal, view.sectors)?;
        let [ranges, members] = grid.members(&cells);
        let values = |channels: usize| vec![0.0; channels * cells.size.stride() * cells.size.height as usize];
        let stride = Size::new(grid.columns as u32, 1).stride();
        Ok(Self {
            looming_params: looming_params(view, ideal, &cells),
            sectors_params: sectors_params(view, &cells),
            ranges,
            members,
            of_cells: values(CHANNELS),
            looming: values(4),
            summed: vec![0.0; sectors::CHANNELS * stride * grid.rows],
            sectors: Sectors::unknown(grid),
            cells,
        })
    }

    /// The cells. Their order is that of the flow given to [`SectorAggregator::of`].
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The grid of the sectors.
    pub fn grid(&self) -> Grid {
        self.sectors.grid
    }

    /// The sectors of the cells' flow between two frames `interval_s` apart. `flows` gives one value per cell, row by
    /// row as [`Cells::rays`]; `None` is an unknown flow, and so are cells that it leaves out at the end.
    pub fn of(
        &mut self,
        flows: impl Iterator<Item = Option<CellFlow>>,
        heading: &Heading,
        interval_s: f64,
    ) -> &Sectors {
        let (columns, stride) = (self.cells.size.width as usize, self.cells.size.stride());
        self.of_cells.fill(0.0);
        for (i, flow) in flows.take(self.cells.size.pixels()).enumerate() {
            let Some(CellFlow { bearing, flow_rad, confidence }) = flow.filter(|flow| flow.bearing.z > 0.01)
            else {
                continue;
            };
            let [rate_x, rate_y] = model::to_plane(bearing, flow_rad);
            let values =
                [confidence, bearing.x / bearing.z, bearing.y / bearing.z, rate_x, rate_y, confidence];
            for (channel, value) in values.into_iter().enumerate() {
                self.of_cells[(CHANNELS * (i / columns) + channel) * stride + i % columns] = value as f32;
            }
        }
        let motion = Motion { prev_from_cur: DMat3::IDENTITY, heading: *heading }.values();
        (looming::KERNEL.reference)(
            bytemuck::bytes_of(&self.looming_params),
            &[&self.of_cells, &motion],
            &mut [&mut self.looming],
        );
        (sectors::KERNEL.reference)(
            bytemuck::bytes_of(&self.sectors_params),
            &[&self.of_cells, &self.looming, &self.ranges, &self.members],
            &mut [&mut self.summed],
        );
        self.sectors.read(&self.summed, interval_s);
        &self.sectors
    }
}
