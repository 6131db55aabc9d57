//! Tracks over their frames.

use std::collections::{HashMap, VecDeque};

use super::draw::{gray, line};
use crate::frame::{Frame, Image};
use crate::tracking::{Track, TrackStatus};

/// Colours that stand out from gray images; a track has one of them by its number.
const COLOURS: [[u8; 3]; 6] =
    [[255, 160, 0], [70, 235, 200], [120, 170, 255], [255, 230, 0], [230, 120, 255], [90, 230, 90]];
/// A new track.
const NEW: [u8; 3] = [255; 3];
/// A track that ends.
const ENDED: [u8; 3] = [255, 60, 60];
/// Half the length of a cross, in pixels.
const ARM: f64 = 2.0;

/// Draws tracks over their frames: the frame in gray, each track's path over the last frames as a line in its own colour,
/// with a cross at its place, white where it is new, and a red cross where it ends.
#[derive(Debug, Default)]
pub struct TrackOverlay {
    /// The number of frames over which a track's path is drawn.
    frames: usize,
    paths: HashMap<u64, VecDeque<[f64; 2]>>,
}

impl TrackOverlay {
    /// An overlay that draws paths over this many frames, beside the current one.
    pub fn new(frames: usize) -> Self {
        Self { frames, paths: HashMap::new() }
    }

    /// Draws a frame's tracks, as [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8).
    pub fn draw(&mut self, frame: &Frame<'_>, tracks: &[Track]) -> Image {
        let mut image = gray(frame);
        for track in tracks {
            let place = [f64::from(track.x), f64::from(track.y)];
            if !place.iter().all(|side| side.is_finite()) {
                continue;
            }
            if !track.status.is_live() {
                // The place where a search was lost means nothing: the cross stands where the track was last.
                let last =
                    self.paths.remove(&track.id).and_then(|path| path.back().copied()).unwrap_or(place);
                cross(&mut image, last, ENDED);
                continue;
            }
            let path = self.paths.entry(track.id).or_default();
            path.push_back(place);
            while path.len() > self.frames + 1 {
                path.pop_front();
            }
            let colour = COLOURS[(track.id % COLOURS.len() as u64) as usize];
            for (from, to) in path.iter().zip(path.iter().skip(1)) {
                line(&mut image, *from, *to, colour);
            }
            cross(&mut image, place, if track.status == TrackStatus::New { NEW } else { colour });
        }
        image
    }
}

fn cross(image: &mut Image, [x, y]: [f64; 2], colour: [u8; 3]) {
    line(image, [x - ARM, y], [x + ARM, y], colour);
    line(image, [x, y - ARM], [x, y + ARM], colour);
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, Size};

    #[test]
    fn a_path_ends_at_its_track_and_is_forgotten_with_it() {
        let size = Size::new(32, 16);
        let data = vec![40; size.pixels()];
        let frame = Frame::new(size, PixelFormat::Gray8, &data).unwrap();
        let track = |x: f32, status| Track {
            id: 1,
            age: 0,
            x,
            y: 8.0,
            shift: [0.0; 2],
            status,
            forward_backward_px: None,
            error: 0.0,
        };
        let mut overlay = TrackOverlay::new(1);
        let colour = |image: &Image, x: usize| image.data.as_chunks::<3>().0[8 * 32 + x];
        let new = overlay.draw(&frame, &[track(4.0, TrackStatus::New)]);
        assert_eq!((colour(&new, 4), colour(&new, 9)), (NEW, [40; 3]));
        overlay.draw(&frame, &[track(12.0, TrackStatus::Tracked)]);
        let third = overlay.draw(&frame, &[track(20.0, TrackStatus::Tracked)]);
        // One frame back, not two.
        assert_eq!((colour(&third, 16), colour(&third, 8)), (COLOURS[1], [40; 3]));
        let last = overlay.draw(&frame, &[track(1e9, TrackStatus::Lost)]);
        assert_eq!((colour(&last, 20), colour(&last, 16)), (ENDED, [40; 3]));
        assert!(overlay.paths.is_empty());
    }
}
