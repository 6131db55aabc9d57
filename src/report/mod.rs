//! Visual reports: flow as colours and arrows, cues as overlays, and HTML pages. Enabled by the feature `report`;
//! reports of simulated flights ([`flight`], [`divergence_strip`]) also need the feature `sim`.

mod arrows;
mod campaign;
#[cfg(feature = "sim")]
mod canvas;
mod colour_wheel;
#[cfg_attr(not(feature = "sim"), allow(dead_code, reason = "most are for pages of flights"))]
mod colours;
#[cfg(all(feature = "io", feature = "sim"))]
mod demo;
mod divergence;
#[cfg(feature = "sim")]
mod divergence_strip;
mod draw;
mod error_map;
#[cfg(feature = "io")]
mod eval;
#[cfg(feature = "sim")]
pub mod flight;
mod font;
#[cfg(feature = "sim")]
mod footprint;
#[cfg_attr(
    not(all(feature = "io", feature = "sim")),
    allow(dead_code, reason = "the demo's page uses all of it")
)]
mod html;
mod overlay;
#[cfg(any(feature = "io", feature = "sim"))]
#[cfg_attr(not(feature = "sim"), allow(dead_code, reason = "flights use all of it"))]
mod plot;
mod rectified;
mod thin;
mod tracks;

pub use arrows::arrows;
pub use campaign::{CampaignRow, campaign_page};
pub use colour_wheel::colour_wheel;
#[cfg(feature = "cli")]
pub(crate) use demo::GENERATOR;
#[cfg(all(feature = "io", feature = "sim"))]
pub use demo::{DemoFlight, DemoPair, DemoReport};
pub use divergence::{FULL_DIVERGENCE_HZ, diverging};
#[cfg(feature = "sim")]
pub use divergence_strip::divergence_strip;
pub use error_map::{ERROR_COLOURS, error_map};
#[cfg(feature = "io")]
pub use eval::{EvalCurves, EvalImage, EvalPage, EvalPair, EvalSet, EvalTable};
pub use overlay::Overlay;
pub use thin::thinned;
pub use tracks::TrackOverlay;
