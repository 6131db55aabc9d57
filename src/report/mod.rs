//! Results to look at.

mod font;
mod overlay;
mod straight;

pub use overlay::Overlay;
