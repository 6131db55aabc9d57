//! Simulated worlds with exact ground truth: images, nearness and flow. Enabled by the feature `sim`; `data_set` also
//! needs the feature `io`, and course files and results of campaigns need `io` and `serde`.
//!
//! A [`World`] consists of planes, rectangles, cylinders and boxes, whose intersections with a ray have a closed
//! form, so that nearness and motion are known to the last digits. Textures are band-limited by the distance of the
//! camera: they show no detail that a pixel could not resolve.
//!
//! ```
//! use viewsphere::camera::{Camera, Lens, Pose};
//! use viewsphere::frame::Size;
//! use viewsphere::sim::{RayTable, reference_render, scenes};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(64, 48);
//! let camera = Camera { size, f_u: 40.0, f_v: 40.0, u_0: 31.5, v_0: 23.5, lens: Lens::NONE };
//! let view = reference_render(&scenes::frontal_wall(4.0)?, &RayTable::new(&camera)?, &scenes::START);
//! assert!((view.nearness_per_m.data[24 * 64 + 32] - 0.25).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```

pub mod campaign;
mod clearance;
pub mod course;
#[cfg(feature = "io")]
pub mod data_set;
pub mod flight;
mod random;
mod ray_query;
mod rays;
mod reference_render;
mod renderer;
pub mod scenes;
mod surface;
mod texture;
mod truth;
pub mod vehicle;
mod world;

pub use course::{Course, CourseKind};
pub use random::Random;
pub use ray_query::{query_rays, ray_grid};
pub use rays::RayTable;
pub use reference_render::{Rendering, nearness, reference_render};
pub use renderer::{Renderer, RendererConfig};
pub use surface::{Form, Surface};
pub use truth::{Seen, Twist, displacement};
pub use world::{Hit, World};
