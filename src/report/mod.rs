//! Results to look at.

mod campaign;
mod canvas;
mod colours;
pub mod flight;
mod font;
mod footprint;
mod html;
mod overlay;
mod plot;
mod straight;

pub use campaign::{CampaignRow, campaign_page};
pub use overlay::Overlay;
