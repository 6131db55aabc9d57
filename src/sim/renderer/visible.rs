//! The surfaces visible from a pose, as input of the kernels: surfaces in the camera's frame, and for each tile of
//! the image those that it may see.

use glam::{DMat3, DVec3};

use crate::camera::Pose;
use crate::error::{Error, Result};
use crate::kernels::surface_layout::{Kind, SURFACE_LEN, SurfaceRecord, TILE};
use crate::sim::surface::Geometry;
use crate::sim::{RayTable, Surface, World};

/// Half the side of the square that stands for an endless plane: 10⁶ km.
const ENDLESS_M: f64 = 1e9;
/// Grid spacing of the texture's coarsest octave.
const CELL_M: f64 = 4.0;
/// The average room per tile for members; a surface in one tile's list is one member.
const MEMBERS_PER_TILE: usize = 128;
/// The least room for members, the longest list that the kernel reads. A small image has few tiles, each of which may see the
/// whole world.
const LEAST_ROOM: usize = 1 << 14;

/// The tiles of an image, and their ranges of x/z and y/z.
pub(super) struct Tiles {
    pub(super) across: usize,
    pub(super) down: usize,
    /// Least and largest x/z of each column of tiles.
    columns: Vec<[f64; 2]>,
    /// Least and largest y/z of each row of tiles.
    rows: Vec<[f64; 2]>,
}

impl Tiles {
    pub(super) fn new(rays: &RayTable) -> Self {
        let sides = [rays.size().width as usize, rays.size().height as usize];
        let [across, down] = [0, 1].map(|axis| sides[axis].div_ceil(TILE[axis]));
        let (mut columns, mut rows) = (vec![NOTHING; across], vec![NOTHING; down]);
        for y in 0..=sides[1] {
            for x in 0..=sides[0] {
                let ray = rays.corner(x, y);
                widen(&mut columns, x, TILE[0], ray.x / ray.z);
                widen(&mut rows, y, TILE[1], ray.y / ray.z);
            }
        }
        Self { across, down, columns, rows }
    }

    pub(super) fn count(&self) -> usize {
        self.across * self.down
    }

    /// The tiles that may see a surface.
    fn that_see<'a>(&'a self, seen: &'a Visible) -> impl Iterator<Item = usize> + 'a {
        let places = (seen.rows[0]..=seen.rows[1])
            .flat_map(move |row| (seen.columns[0]..=seen.columns[1]).map(move |column| [column, row]));
        let may_see = places.filter(move |place| !self.passes(*place, seen));
        may_see.map(move |[column, row]| row * self.across + column)
    }

    /// Whether all rays of a tile pass a cylinder on one side.
    fn passes(&self, [column, row]: [usize; 2], seen: &Visible) -> bool {
        let ([x0, x1], [y0, y1]) = (self.columns[column], self.rows[row]);
        let n = seen.beside;
        let middle = (n.x * (x0 + x1) + n.y * (y0 + y1)) / 2.0 + n.z;
        let spread = (n.x.abs() * (x1 - x0) + n.y.abs() * (y1 - y0)) / 2.0;
        let longest = (1.0 + (x0 * x0).max(x1 * x1) + (y0 * y0).max(y1 * y1)).sqrt();
        middle.abs() - spread > seen.sine * longest
    }
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Widens the ranges at a corner; one between two tiles belongs to both.
fn widen(ranges: &mut [[f64; 2]], corner: usize, side: usize, tangent: f64) {
    let last = ranges.len() - 1;
    for range in &mut ranges[(corner.max(1) - 1) / side..=(corner / side).min(last)] {
        // min and max ignore NaN.
        *range = [range[0].min(tangent), range[1].max(tangent)];
    }
}

/// The buffers of one pose.
pub(super) struct VisibleSurfaces {
    /// The up direction, then the surfaces' records.
    pub(super) surfaces: Vec<f32>,
    /// Per tile: its first box in `members`, their number, its first cylinder, their number.
    pub(super) lists: Vec<f32>,
    pub(super) members: Vec<f32>,
    visible: Vec<Visible>,
    /// Per tile, the numbers of boxes and cylinders.
    counts: Vec<[usize; 2]>,
}

/// A visible surface.
#[derive(Clone, Copy)]
struct Visible {
    number: usize,
    nearest_m: f64,
    local_from_camera: DMat3,
    camera_local: DVec3,
    /// First and last column and row of the tiles that may see it.
    columns: [usize; 2],
    rows: [usize; 2],
    round: bool,
    /// Normal, in the camera's frame, of the plane through the camera and a cylinder's axis; 0 for other shapes.
    beside: DVec3,
    /// The sine of the half angle that the cylinder subtends on either side of that plane.
    sine: f64,
}

impl VisibleSurfaces {
    pub(super) fn new(tiles: &Tiles, world: &World) -> Self {
        Self {
            surfaces: Vec::with_capacity(Self::surface_values(world)),
            lists: vec![0.0; 4 * tiles.count()],
            members: Vec::with_capacity(Self::most_members(tiles, world)),
            visible: Vec::with_capacity(world.surfaces.len()),
            counts: vec![[0; 2]; tiles.count()],
        }
    }

    /// The length of the `surfaces` buffer for a whole world.
    pub(super) fn surface_values(world: &World) -> usize {
        4 + SURFACE_LEN * world.surfaces.len()
    }

    /// The length of the `members` buffer.
    pub(super) fn most_members(tiles: &Tiles, world: &World) -> usize {
        let room = (tiles.count() * MEMBERS_PER_TILE).max(LEAST_ROOM);
        room.min(tiles.count() * world.surfaces.len()).max(1)
    }

    /// Fills the buffers for a pose.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the tiles see more surfaces than fit.
    pub(super) fn fill(&mut self, tiles: &Tiles, world: &World, pose: &Pose, range_m: f64) -> Result<()> {
        self.see(tiles, world, pose, range_m);
        self.counts.fill([0; 2]);
        for seen in &self.visible {
            for tile in tiles.that_see(seen) {
                self.counts[tile][usize::from(seen.round)] += 1;
            }
        }
        let mut first = 0;
        for (list, counts) in self.lists.as_chunks_mut::<4>().0.iter_mut().zip(&mut self.counts) {
            let [boxes, cylinders] = *counts;
            *list = [first, boxes, first + boxes, cylinders].map(|value| value as f32);
            // From here on, the position of the next member.
            *counts = [first, first + boxes];
            first += boxes + cylinders;
        }
        let most = Self::most_members(tiles, world);
        if first > most {
            let found = format!("one of whose surfaces the image's tiles see {first} in total");
            let expected = format_args!(
                "at most {most}, which is {MEMBERS_PER_TILE} for each tile of {} × {} pixels: a larger image, or a world \
                 with fewer surfaces",
                TILE[0], TILE[1]
            );
            return Err(Error::parameter("world", found, expected));
        }
        self.members.clear();
        self.members.resize(first, 0.0);
        for (index, seen) in self.visible.iter().enumerate() {
            for tile in tiles.that_see(seen) {
                let next = &mut self.counts[tile][usize::from(seen.round)];
                self.members[*next] = index as f32;
                *next += 1;
            }
        }
        self.surfaces.clear();
        let up = pose.world_from_camera.transpose() * world.up_world;
        self.surfaces.extend([up.x as f32, up.y as f32, up.z as f32, 0.0]);
        for seen in &self.visible {
            self.surfaces.extend(record(seen, &world.surfaces[seen.number]).values());
        }
        Ok(())
    }

    /// Finds the visible surfaces, nearest first.
    fn see(&mut self, tiles: &Tiles, world: &World, pose: &Pose, range_m: f64) {
        self.visible.clear();
        let whole = |ranges: &[[f64; 2]]| {
            ranges.iter().fold(NOTHING, |all, range| [all[0].min(range[0]), all[1].max(range[1])])
        };
        let (x, y) = (whole(&tiles.columns), whole(&tiles.rows));
        let [right, down, ahead] = pose.world_from_camera.to_cols_array_2d().map(DVec3::from);
        let sides = [right - x[0] * ahead, x[1] * ahead - right, down - y[0] * ahead, y[1] * ahead - down];
        for (number, surface) in world.surfaces.iter().enumerate() {
            if !sides.iter().all(|side| surface.reaches(pose.position_world, *side)) {
                continue;
            }
            let nearest_m = surface.distance_m(pose.position_world).abs();
            if nearest_m > range_m {
                continue;
            }
            let local_from_camera = surface.local_from_world * pose.world_from_camera;
            let camera_local = surface.local_from_world * (pose.position_world - surface.origin_world);
            let ahead = local_from_camera.z_axis;
            let within = |ranges: &[[f64; 2]], across: DVec3| {
                let reaches = |normal: DVec3| surface.shape.reaches(normal, -normal.dot(camera_local));
                let seen = |range: &[f64; 2]| {
                    reaches(across - range[0] * ahead) && reaches(range[1] * ahead - across)
                };
                // A convex surface is seen by adjacent tiles.
                let first = ranges.iter().position(seen)?;
                ranges.iter().rposition(seen).map(|last| [first, last])
            };
            let columns = within(&tiles.columns, local_from_camera.x_axis);
            let rows = within(&tiles.rows, local_from_camera.y_axis);
            let (Some(columns), Some(rows)) = (columns, rows) else { continue };
            let (beside, sine) = match surface.shape {
                Geometry::Cylinder { radius_m, .. } => {
                    let away_m = camera_local.truncate().length();
                    let normal = DVec3::new(-camera_local.y, camera_local.x, 0.0) / away_m;
                    // The margin covers rounding.
                    (local_from_camera.transpose() * normal, radius_m / away_m + 1e-6)
                }
                _ => (DVec3::ZERO, 1.0),
            };
            self.visible.push(Visible {
                number,
                nearest_m,
                local_from_camera,
                camera_local,
                columns,
                rows,
                round: matches!(surface.shape, Geometry::Cylinder { .. }),
                beside,
                sine,
            });
        }
        self.visible
            .sort_unstable_by(|a, b| a.nearest_m.total_cmp(&b.nearest_m).then(a.number.cmp(&b.number)));
    }
}

fn record(seen: &Visible, surface: &Surface) -> SurfaceRecord {
    let (half_m, middle_m, kind) = match surface.shape {
        Geometry::Plane => (DVec3::new(ENDLESS_M, ENDLESS_M, 0.0), 0.0, Kind::Flat),
        Geometry::Rectangle { half_m: [a, b] } => (DVec3::new(a, b, 0.0), 0.0, Kind::Flat),
        Geometry::Cylinder { radius_m, length_m } => {
            (DVec3::new(radius_m, radius_m, length_m / 2.0), length_m / 2.0, Kind::Cylinder)
        }
        Geometry::Cuboid { half_m } => (half_m, 0.0, Kind::Cuboid),
    };
    let place = seen.camera_local;
    let cells = (place / CELL_M).floor();
    let rows = seen.local_from_camera.transpose().to_cols_array_2d();
    SurfaceRecord {
        axes: rows.map(|row| row.map(|value| value as f32)),
        place_m: (place - DVec3::Z * middle_m).as_vec3().to_array(),
        half_m: half_m.as_vec3().to_array(),
        // Rounding could move it beyond the nearest point.
        nearest_m: (seen.nearest_m * (1.0 - 1e-6)) as f32,
        texture_m: (place - cells * CELL_M).as_vec3().to_array(),
        cells: cells.as_vec3().to_array(),
        number: seen.number as u32,
        kind,
    }
}
