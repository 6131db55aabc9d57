//! A flight to look at: frame by frame as a video or in a page, and as a whole as a page.

pub(super) mod curves;
mod danger;
#[cfg(feature = "io")]
mod film;
mod map;
pub(super) mod page;
#[cfg(feature = "io")]
pub(super) mod player;
#[cfg(feature = "io")]
mod script;
mod video;
mod views;
mod way;

#[cfg(feature = "io")]
pub use film::FlightFilm;
pub use page::FlightReport;
pub use video::FlightVideo;
