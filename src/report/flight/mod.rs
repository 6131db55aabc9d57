//! Reports of a flight: a video, a film for a page, and a page about the whole flight.

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
