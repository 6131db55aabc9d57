//! Results to look at.

mod campaign;
mod canvas;
mod colours;
mod demo;
mod divergence;
pub mod flight;
mod font;
mod footprint;
mod html;
mod overlay;
mod plot;
mod straight;

pub use campaign::{CampaignRow, campaign_page};
#[cfg(feature = "cli")]
pub(crate) use demo::GENERATOR;
pub use demo::{DemoFlight, DemoPair, DemoReport};
pub use divergence::{FULL_DIVERGENCE_HZ, divergence_strip, diverging};
#[cfg(feature = "cli")]
pub(crate) use html::counted;
pub use overlay::Overlay;
