//! A flight to look at: frame by frame as a video, and as a whole as a page.

mod curves;
mod danger;
mod map;
mod page;
mod video;
mod way;

pub use page::FlightReport;
pub use video::FlightVideo;
