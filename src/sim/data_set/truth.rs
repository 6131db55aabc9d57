//! The ground truth of each frame.

use super::Paint;
use super::flown::motion;
use super::folder::Folder;
use crate::camera::{Camera, Framing, Lens};
use crate::error::Result;
use crate::frame::{Plane, Size};
use crate::io::{flo, npy, picture, write_bytes};
use crate::sim::vehicle::VehicleState;
use crate::sim::{RayTable, Seen, World, displacement, query_rays, ray_grid};
use crate::sphere::Grid;

/// The divergence of a wall ahead one second before contact, 1/s.
const FULL_DIVERGENCE_HZ: f64 = 2.0;

/// A kind of ground truth that can be written beside the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Flow in pixels to the next frame, `.flo`.
    Flow,
    /// Distance along each pixel's ray in metres, `.npy`.
    Depth,
    /// The inverse of the depth, 1/m, `.npy`.
    Nearness,
    /// Divergence of the flow on the view sphere, 1/s, `.npy`.
    Divergence,
    /// Flow on the view sphere in the camera's frame, rad/s, `.npy`.
    Spherical,
    /// Distances along rays at evenly spaced azimuths and elevations in metres, `.npy`.
    Grid,
}

impl Truth {
    /// All kinds.
    pub const ALL: [Self; 6] =
        [Self::Flow, Self::Depth, Self::Nearness, Self::Divergence, Self::Spherical, Self::Grid];

    /// The name, also that of the folder.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flow => "flow",
            Self::Depth => "depth",
            Self::Nearness => "nearness",
            Self::Divergence => "divergence",
            Self::Spherical => "spherical",
            Self::Grid => "grid",
        }
    }

    /// The size of a frame's file without its header, for images and a grid of these sizes.
    pub fn bytes(self, size: Size, grid: Size) -> f64 {
        let (pixels, rays) = (size.pixels() as f64, grid.pixels() as f64);
        match self {
            Self::Flow => 8.0 * pixels,
            Self::Depth | Self::Nearness | Self::Divergence => 4.0 * pixels,
            Self::Spherical => 12.0 * pixels,
            Self::Grid => 4.0 * rays,
        }
    }

    /// The value shown in full colour, if this kind can be painted: that of a wall ahead one second before contact at
    /// this speed.
    pub fn full_colour(self, speed_m_s: f64) -> Option<f64> {
        match self {
            Self::Divergence => Some(FULL_DIVERGENCE_HZ),
            Self::Nearness => Some(speed_m_s.recip()),
            _ => None,
        }
    }
}

/// Writes ground truth.
pub(super) struct Writer<'a> {
    world: &'a World,
    camera: &'a Camera,
    truths: &'a [Truth],
    rays: RayTable,
    grid: Grid,
    /// The painter, and the speed that sets the colour scale.
    paint: Option<(Paint, f64)>,
}

impl<'a> Writer<'a> {
    pub(super) fn new(
        world: &'a World,
        camera: &'a Camera,
        truths: &'a [Truth],
        grid: Size,
        paint: Option<(Paint, f64)>,
    ) -> Result<Self> {
        let grid = grid_over(camera, grid.validate()?)?;
        Ok(Self { world, camera, truths, rays: RayTable::new(camera)?, grid, paint })
    }

    /// Writes the ground truth of a frame. There is no flow without a next frame.
    pub(super) fn write(
        &self,
        folder: &Folder,
        number: usize,
        state: &VehicleState,
        next: Option<&VehicleState>,
    ) -> Result<()> {
        let (pose, motion) = (state.camera_pose(), motion(state));
        let per_pixel = |truth: &Truth| !matches!(truth, Truth::Flow | Truth::Grid);
        let seen = match self.truths.iter().any(per_pixel) {
            true => query_rays(self.world, &self.rays, &pose),
            false => Vec::new(),
        };
        let size = self.camera.size;
        let plane = |of: &dyn Fn(&Seen) -> f64| {
            let data = seen.iter().map(|seen| seen.as_ref().map_or(f32::NAN, |seen| of(seen) as f32));
            Plane { size, data: data.collect() }
        };
        let shown = |truth: &Truth, plane: Plane| -> Result<Vec<u8>> {
            let paint = self.paint.and_then(|(paint, speed)| Some((paint, truth.full_colour(speed)?)));
            if let Some((paint, full)) = paint {
                let path = folder.path(&format!("{}/{number:06}.png", truth.name()));
                picture::write_png(path, &paint(&plane, full)?)?;
            }
            npy::encode_plane(&plane)
        };
        for truth in self.truths {
            let bytes = match truth {
                Truth::Flow => {
                    let Some(next) = next else { continue };
                    let to = next.camera_pose();
                    flo::encode(&displacement(self.world, self.camera, &self.rays, &pose, &to)?)?
                }
                Truth::Depth => npy::encode_plane(&plane(&|seen| seen.nearness_per_m.recip()))?,
                Truth::Nearness => shown(truth, plane(&|seen| seen.nearness_per_m))?,
                Truth::Divergence => shown(truth, plane(&|seen| seen.divergence_per_s(&motion)))?,
                Truth::Spherical => {
                    let flow = |seen: &Option<Seen>| {
                        seen.map_or([f32::NAN; 3], |seen| seen.flow_rad_s(&motion).as_vec3().to_array())
                    };
                    npy::encode_triples(size, &seen.iter().map(flow).collect::<Vec<_>>())?
                }
                Truth::Grid => npy::encode_plane(&ray_grid(self.world, &pose, &self.grid)?)?,
            };
            let extension = if *truth == Truth::Flow { "flo" } else { "npy" };
            write_bytes(folder.path(&format!("{}/{number:06}.{extension}", truth.name())), &bytes)?;
        }
        Ok(())
    }
}

/// A grid of evenly spaced azimuths and elevations over a camera's field of view.
pub(super) fn grid_over(camera: &Camera, Size { width, height }: Size) -> Result<Grid> {
    let ideal = match camera.lens {
        Lens::NONE => *camera,
        _ => camera.ideal(camera.size, Framing::KeepAll)?,
    };
    Ok(Grid { columns: width as usize, rows: height as usize, ..Grid::over(&ideal, [1, 1])? })
}
