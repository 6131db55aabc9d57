//! Sectors of the view: a grid of azimuths and elevations.

use std::fmt;

use glam::DVec3;

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::frame::Size;

/// A grid of azimuths and elevations over a camera's field of view.
///
/// Azimuth is `atan2(x, z)`, positive to the right; elevation is `atan2(−y, √(x² + z²))`, positive up, both in the
/// camera's frame. Column 0 is the leftmost one, row 0 the highest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Sectors per row.
    pub columns: usize,
    /// Rows of sectors.
    pub rows: usize,
    /// Azimuths of the left and the right border, in radians.
    pub azimuth_rad: [f64; 2],
    /// Elevations of the upper and the lower border, in radians.
    pub elevation_rad: [f64; 2],
}

impl Grid {
    /// The largest number of columns and of rows.
    pub const MAX_SIDE: u32 = 256;

    /// The grid over the whole view of an ideal camera.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a number of columns or rows outside 1 to 256.
    pub fn over(camera: &Camera, [columns, rows]: [u32; 2]) -> Result<Self> {
        for (name, value) in [("sector columns", columns), ("sector rows", rows)] {
            if !(1..=Self::MAX_SIDE).contains(&value) {
                let expected = format!("1 to {}", Self::MAX_SIDE);
                return Err(Error::parameter(name, value, expected));
            }
        }
        // Half a pixel beyond the outermost centres.
        let across = |u: f64| (u - camera.u_0) / camera.f_u;
        let down = |v: f64| (v - camera.v_0) / camera.f_v;
        let (left, right) = (across(-0.5), across(f64::from(camera.size.width) - 0.5));
        let (top, bottom) = (down(-0.5), down(f64::from(camera.size.height) - 0.5));
        // The steepest elevations are seen in the column nearest to the axis.
        let middle = 0.0_f64.clamp(left, right);
        let elevation = |y: f64| (-y).atan2(middle.hypot(1.0));
        Ok(Self {
            columns: columns as usize,
            rows: rows as usize,
            azimuth_rad: [left.atan(), right.atan()],
            elevation_rad: [elevation(top), elevation(bottom)],
        })
    }

    /// Number of sectors.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether there is no sector, which [`Grid::over`] rules out.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Width and height of a sector, in radians.
    pub fn pitch_rad(&self) -> [f64; 2] {
        [
            (self.azimuth_rad[1] - self.azimuth_rad[0]) / self.columns as f64,
            (self.elevation_rad[0] - self.elevation_rad[1]) / self.rows as f64,
        ]
    }

    /// Azimuth and elevation of a sector's centre, in radians.
    pub fn angles_rad(&self, column: usize, row: usize) -> [f64; 2] {
        let pitch = self.pitch_rad();
        [
            self.azimuth_rad[0] + (column as f64 + 0.5) * pitch[0],
            self.elevation_rad[0] - (row as f64 + 0.5) * pitch[1],
        ]
    }

    /// The unit bearing of a sector's centre, in the camera's frame.
    pub fn bearing(&self, column: usize, row: usize) -> DVec3 {
        bearing(self.angles_rad(column, row))
    }

    /// Column and row of the sector that contains a bearing; `None` outside the grid.
    pub fn sector(&self, bearing: DVec3) -> Option<[usize; 2]> {
        let [azimuth, elevation] = angles_rad(bearing);
        let [across, up] = self.pitch_rad();
        let column = ((azimuth - self.azimuth_rad[0]) / across).floor();
        let row = ((self.elevation_rad[0] - elevation) / up).floor();
        let inside = (0.0..self.columns as f64).contains(&column) && (0.0..self.rows as f64).contains(&row);
        inside.then_some([column as usize, row as usize])
    }

    /// The cells of each sector: for each sector the first index and the count in the list of members, then that list.
    pub(super) fn members(&self, cells: &Cells) -> [Vec<f32>; 2] {
        let mut lists = vec![Vec::new(); self.len()];
        for (number, ray) in cells.rays().enumerate() {
            if let Some([column, row]) = self.sector(ray) {
                lists[row * self.columns + column].push(number as f32);
            }
        }
        let mut first = 0;
        let range = |list: &Vec<f32>| {
            let range = [first as f32, list.len() as f32];
            first += list.len();
            range
        };
        let ranges = lists.iter().flat_map(range).collect();
        // A buffer holds at least one value.
        let mut members = lists.concat();
        if members.is_empty() {
            members.push(0.0);
        }
        [ranges, members]
    }
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}×{}", self.columns, self.rows)
    }
}

/// The unit bearing at an azimuth and elevation, in the camera's frame.
pub fn bearing([azimuth_rad, elevation_rad]: [f64; 2]) -> DVec3 {
    let (sin, cos) = azimuth_rad.sin_cos();
    let (up, level) = elevation_rad.sin_cos();
    DVec3::new(level * sin, -up, level * cos)
}

/// Azimuth and elevation of a bearing of the camera's frame, in radians.
pub fn angles_rad(bearing: DVec3) -> [f64; 2] {
    [bearing.x.atan2(bearing.z), (-bearing.y).atan2(bearing.x.hypot(bearing.z))]
}

/// The square cells over which the flow is averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// Columns and rows of cells.
    pub size: Size,
    /// Side of a cell in pixels.
    pub side: u32,
    pub(super) camera: Camera,
}

impl Cells {
    pub(super) fn over(camera: &Camera, side: u32) -> Self {
        let Size { width, height } = camera.size;
        Self { size: Size::new(width.div_ceil(side), height.div_ceil(side)), side, camera: *camera }
    }

    /// The first cell's centre in the plane at unit distance, and the distance from one centre to the next.
    pub(super) fn origin_and_pitch(&self) -> [[f64; 2]; 2] {
        let Camera { f_u, f_v, u_0, v_0, .. } = self.camera;
        let side = f64::from(self.side);
        let first = 0.5 * (side - 1.0);
        [[(first - u_0) / f_u, (first - v_0) / f_v], [side / f_u, side / f_v]]
    }

    /// The directions of the cells' centres in the camera's frame, row by row from the upper left, with z = 1 (not unit
    /// vectors).
    pub fn rays(&self) -> impl Iterator<Item = DVec3> + use<> {
        let [origin, pitch] = self.origin_and_pitch();
        let Size { width, height } = self.size;
        (0..height).flat_map(move |y| {
            (0..width).map(move |x| {
                DVec3::new(origin[0] + f64::from(x) * pitch[0], origin[1] + f64::from(y) * pitch[1], 1.0)
            })
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::camera::Lens;

    fn camera() -> Camera {
        let size = Size::new(640, 480);
        Camera { size, f_u: 300.0, f_v: 310.0, u_0: 310.0, v_0: 245.0, lens: Lens::NONE }
    }

    #[test]
    fn a_sector_holds_its_own_middle() {
        let grid = Grid::over(&camera(), [24, 9]).unwrap();
        for row in 0..9 {
            for column in 0..24 {
                assert_eq!(grid.sector(grid.bearing(column, row)), Some([column, row]));
                let [azimuth, elevation] = angles_rad(grid.bearing(column, row));
                let expected = grid.angles_rad(column, row);
                assert!((azimuth - expected[0]).abs() < 1e-12 && (elevation - expected[1]).abs() < 1e-12);
            }
        }
        assert_eq!(grid.sector(-DVec3::Z), None);
    }

    #[test]
    fn every_cell_of_the_view_is_in_one_sector() {
        let cells = Cells::over(&camera(), 8);
        let [ranges, members] = Grid::over(&camera(), [24, 9]).unwrap().members(&cells);
        assert_eq!(ranges.len(), 2 * 24 * 9);
        let mut sorted: Vec<u32> = members.iter().map(|member| *member as u32).collect();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..cells.size.pixels() as u32).collect::<Vec<_>>());
        let counted: f32 = ranges.chunks(2).map(|range| range[1]).sum();
        assert_eq!(counted as usize, members.len());
    }

    #[test]
    fn right_and_up_are_positive() {
        assert!(angles_rad(DVec3::new(0.1, -0.2, 1.0)).iter().all(|angle| *angle > 0.0));
        assert!(angles_rad(DVec3::new(-0.1, 0.2, 1.0)).iter().all(|angle| *angle < 0.0));
        assert!((angles_rad(DVec3::new(1.0, 0.0, -0.1))[0] - 1.67).abs() < 0.01);
    }
}
