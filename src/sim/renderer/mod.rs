//! The simulated camera, as kernels for the GPU or the CPU: the images of
//! [`reference_render`](super::reference_render), fast enough for flights, and with a sensor's noise.
//!
//! An image takes three kernels: `cast` finds the surfaces that four samples of each pixel meet, `shade` computes its
//! gray level, `sensor` adds noise and rounds. Positions are made relative to the camera on the host in `f64`, and
//! then rounded.
//!
//! ```
//! use viewsphere::Backend;
//! use viewsphere::camera::{Camera, Lens};
//! use viewsphere::frame::Size;
//! use viewsphere::sim::{Renderer, RendererConfig, scenes};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(64, 48);
//! let camera = Camera { size, f_u: 40.0, f_v: 40.0, u_0: 31.5, v_0: 23.5, lens: Lens::NONE };
//! let world = scenes::frontal_wall(4.0)?;
//! let mut renderer = Renderer::new(Backend::Cpu, &camera, &world, &RendererConfig::default())?;
//! assert_eq!(renderer.render(&scenes::START, 7)?.data.len(), 64 * 48);
//! assert!((renderer.nearness().data[24 * 64 + 32] - 0.25).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```

mod config;
mod steps;
mod visible;

pub use config::RendererConfig;

use self::visible::{Tiles, VisibleSurfaces};
use super::{RayTable, World};
use crate::backend::Backend;
use crate::camera::{Camera, Pose};
use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Plane};
use crate::kernels::sensor;
use crate::plan::Value;
use crate::runner::Runner;

/// A camera in a world.
pub struct Renderer {
    config: RendererConfig,
    world: World,
    tiles: Tiles,
    sharp: Runner,
    /// The runner of an exposure of several poses; `None` if an exposure is one pose.
    exposure: Option<Runner>,
    scenes: Vec<VisibleSurfaces>,
    /// Pixels where the lens shows nothing, row by row.
    blind: Vec<bool>,
    image: Image,
    nearness_per_m: Plane,
}

impl Renderer {
    /// A renderer for a camera in a world.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a configuration, size or up direction out of range, [`Error::TooLarge`] and
    /// [`Error::OutOfMemory`] if the adapter cannot hold such images, [`Error::DeviceLost`] if the device is lost.
    pub fn new(backend: Backend, camera: &Camera, world: &World, config: &RendererConfig) -> Result<Self> {
        config.validate()?;
        if !((world.up_world.length() - 1.0).abs() <= 1e-6) {
            return Err(Error::parameter("up_world", world.up_world, "a unit vector"));
        }
        let rays = RayTable::new(camera)?;
        let size = rays.size();
        let tiles = Tiles::new(&rays);
        let runner = |poses: usize| Runner::new(&backend, steps::plan(&rays, &tiles, world, config, poses)?);
        let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
        Ok(Self {
            sharp: runner(1)?,
            exposure: (config.blur_poses > 1).then(|| runner(config.blur_poses)).transpose()?,
            scenes: (0..config.blur_poses).map(|_| VisibleSurfaces::new(&tiles, world)).collect(),
            blind: pixels.map(|(x, y)| rays.bearing(x, y).is_none()).collect(),
            image: Image { size, format: PixelFormat::Gray8, data: vec![0; size.pixels()] },
            nearness_per_m: Plane { size, data: vec![0.0; size.pixels()] },
            config: config.clone(),
            world: world.clone(),
            tiles,
        })
    }

    /// Renders the image from a pose, without motion blur. Equal poses and seeds give equal bytes on the same device.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a pose that is not finite or not a rotation, or whose tiles see more surfaces than
    /// fit: 128 per tile on average. [`Error::DeviceLost`] if the device was lost.
    pub fn render(&mut self, pose: &Pose, frame_seed: u64) -> Result<&Image> {
        self.see(std::slice::from_ref(pose), frame_seed)
    }

    /// Renders the mean of the images from the poses of an exposure, [`RendererConfig::blur_poses`] of them in the
    /// order of time.
    ///
    /// # Errors
    /// As in [`Renderer::render`]; [`Error::Length`] for another number of poses.
    pub fn expose(&mut self, poses: &[Pose], frame_seed: u64) -> Result<&Image> {
        let expected = self.config.blur_poses;
        if poses.len() != expected {
            return Err(Error::Length { what: "exposure", found: poses.len(), expected });
        }
        self.see(poses, frame_seed)
    }

    /// The nearness of the last image, 1/m along each pixel's central ray: 0 for the sky, NaN where the lens shows
    /// nothing. For an exposure, that of its middle pose. For a pixel with an edge in it, that of the nearest surface
    /// that one of its samples and its centre meet.
    pub fn nearness(&self) -> &Plane {
        &self.nearness_per_m
    }

    fn see(&mut self, poses: &[Pose], frame_seed: u64) -> Result<&Image> {
        let Self { config, world, tiles, sharp, exposure, scenes, blind, image, nearness_per_m } = self;
        for (scene, pose) in scenes.iter_mut().zip(poses) {
            check(pose)?;
            scene.fill(tiles, world, pose, config.range_m)?;
        }
        let seed = sensor::seed_words(frame_seed);
        let mut given = vec![("seed", Some(Value::Raw(&seed)))];
        for (scene, [surfaces, lists, members]) in scenes.iter().zip(steps::POSES).take(poses.len()) {
            given.extend([
                (surfaces, Some(Value::Raw(&scene.surfaces))),
                (lists, Some(Value::Raw(&scene.lists))),
                (members, Some(Value::Raw(&scene.members))),
            ]);
        }
        let runner = exposure.as_mut().filter(|_| poses.len() > 1).unwrap_or(sharp);
        let outputs = runner.run(&given)?;
        let (Some(picture), Some(nearness)) = (outputs.plane("picture"), outputs.plane("nearness")) else {
            unreachable!("the plan has these outputs");
        };
        image.data.iter_mut().zip(&picture.data).for_each(|(gray, level)| *gray = *level as u8);
        for ((near, blind), from) in nearness_per_m.data.iter_mut().zip(blind).zip(&nearness.data) {
            *near = if *blind { f32::NAN } else { *from };
        }
        Ok(&self.image)
    }
}

/// Checks that a pose is finite and a rotation.
fn check(pose: &Pose) -> Result<()> {
    if !pose.position_world.is_finite() {
        return Err(Error::parameter("position_world", pose.position_world, "three finite coordinates"));
    }
    let turn = pose.world_from_camera;
    let off = (turn * turn.transpose() - glam::DMat3::IDENTITY).to_cols_array();
    if !off.iter().all(|e| e.abs() <= 1e-6) {
        return Err(Error::parameter("world_from_camera", turn, "a rotation"));
    }
    Ok(())
}
