//! Antialiased shapes on a part of an image.

use super::font;
use crate::frame::Image;

/// A part of an image of [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8) to draw on. Positions are in pixels
/// from its upper left corner; what lies outside is clipped.
pub(super) struct Canvas<'a> {
    image: &'a mut Image,
    corner: [usize; 2],
    size: [usize; 2],
}

impl<'a> Canvas<'a> {
    /// The part that starts at a corner, clipped to the image.
    pub(super) fn new(image: &'a mut Image, corner: [usize; 2], size: [usize; 2]) -> Self {
        let whole = [image.size.width as usize, image.size.height as usize];
        let corner = std::array::from_fn(|i| corner[i].min(whole[i]));
        let size = std::array::from_fn(|i| size[i].min(whole[i] - corner[i]));
        Self { image, corner, size }
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [f64; 2] {
        self.size.map(|side| side as f64)
    }

    /// Fills the canvas with one colour.
    pub(super) fn fill(&mut self, colour: [u8; 3]) {
        let [right, bottom] = self.size();
        self.paint([[0.0, 0.0], [right, bottom]], colour, |_| 1.0);
    }

    /// Draws a rectangle between two corners.
    pub(super) fn rectangle(&mut self, corners: [[f64; 2]; 2], colour: [u8; 3], opacity: f64) {
        let [[left, top], [right, bottom]] = corners;
        let inside = |[x, y]: [f64; 2]| {
            let beyond = (left - x).max(x - right).max(top - y).max(y - bottom);
            opacity * (0.5 - beyond).clamp(0.0, 1.0)
        };
        self.paint(corners, colour, inside);
    }

    /// Draws a line through points, `width` pixels wide.
    pub(super) fn stroke(&mut self, points: &[[f64; 2]], width: f64, colour: [u8; 3]) {
        let half = 0.5 * width;
        for ends in points.windows(2) {
            let covered = |place| (half + 0.5 - to_segment(place, ends[0], ends[1])).clamp(0.0, 1.0);
            self.paint(around(ends, half), colour, covered);
        }
    }

    /// Draws a disc.
    pub(super) fn disc(&mut self, centre: [f64; 2], radius: f64, colour: [u8; 3], opacity: f64) {
        let covered = |[x, y]: [f64; 2]| {
            opacity * (radius + 0.5 - (x - centre[0]).hypot(y - centre[1])).clamp(0.0, 1.0)
        };
        self.paint(around(&[centre], radius), colour, covered);
    }

    /// Draws a circle, `width` pixels wide.
    pub(super) fn ring(&mut self, centre: [f64; 2], radius: f64, width: f64, colour: [u8; 3]) {
        let covered = |[x, y]: [f64; 2]| {
            let off = ((x - centre[0]).hypot(y - centre[1]) - radius).abs();
            (0.5 * width + 0.5 - off).clamp(0.0, 1.0)
        };
        self.paint(around(&[centre], radius + width), colour, covered);
    }

    /// Fills a closed polygon.
    pub(super) fn polygon(&mut self, points: &[[f64; 2]], colour: [u8; 3], opacity: f64) {
        let sides = || points.iter().zip(points.iter().cycle().skip(1));
        let covered = |place: [f64; 2]| {
            let crossed = sides().filter(|(a, b)| {
                let across = (a[1] > place[1]) != (b[1] > place[1]);
                across && place[0] < a[0] + (place[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            });
            let inside = crossed.count() % 2 == 1;
            let edge = sides().map(|(a, b)| to_segment(place, *a, *b)).fold(f64::INFINITY, f64::min);
            opacity * (0.5 + if inside { edge } else { -edge }).clamp(0.0, 1.0)
        };
        self.paint(around(points, 0.0), colour, covered);
    }

    /// Writes text on black, with its first dot at a position.
    pub(super) fn text(&mut self, at: [f64; 2], text: &str, colour: [u8; 3], scale: usize) {
        let at = std::array::from_fn(|i| at[i] + self.corner[i] as f64);
        font::text(self.image, at, text, colour, scale);
    }

    /// Blends a colour in by the coverage of each pixel between two corners.
    fn paint(&mut self, corners: [[f64; 2]; 2], colour: [u8; 3], covered: impl Fn([f64; 2]) -> f64) {
        let width = self.image.size.width as usize;
        let range = |i: usize| {
            let [a, b] = [corners[0][i].min(corners[1][i]) - 1.0, corners[0][i].max(corners[1][i]) + 2.0];
            // NaN becomes 0.
            (a.max(0.0) as usize).min(self.size[i])..(b.max(0.0) as usize).min(self.size[i])
        };
        for y in range(1) {
            for x in range(0) {
                let share = covered([x as f64 + 0.5, y as f64 + 0.5]);
                if !(share > 0.0) {
                    continue;
                }
                let at = 3 * ((self.corner[1] + y) * width + self.corner[0] + x);
                for (below, above) in self.image.data[at..at + 3].iter_mut().zip(colour) {
                    *below = ((1.0 - share) * f64::from(*below) + share * f64::from(above)).round() as u8;
                }
            }
        }
    }
}

/// The bounding rectangle of points, with a margin.
fn around(points: &[[f64; 2]], margin: f64) -> [[f64; 2]; 2] {
    let fold = |start: f64, sign: f64, of: fn(f64, f64) -> f64| {
        std::array::from_fn(|i| points.iter().map(|point| point[i]).fold(start, of) + sign * margin)
    };
    [fold(f64::INFINITY, -1.0, f64::min), fold(f64::NEG_INFINITY, 1.0, f64::max)]
}

fn to_segment(place: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let off = [place[0] - from[0], place[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 { (off[0] * along[0] + off[1] * along[1]) / square } else { 0.0 };
    let part = part.clamp(0.0, 1.0);
    (off[0] - part * along[0]).hypot(off[1] - part * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, Size};

    const SIZE: Size = Size::new(20, 16);

    fn drawn(draw: impl FnOnce(&mut Canvas<'_>)) -> Vec<u8> {
        let mut image = Image { size: SIZE, format: PixelFormat::Rgb8, data: vec![0; 3 * SIZE.pixels()] };
        draw(&mut Canvas::new(&mut image, [4, 2], [12, 10]));
        image.data.as_chunks::<3>().0.iter().map(|pixel| pixel[0]).collect()
    }

    fn sum(gray: &[u8]) -> f64 {
        gray.iter().map(|gray| f64::from(*gray)).sum::<f64>() / 255.0
    }

    #[test]
    fn shapes_cover_their_area() {
        // A disc's soft edge is a pixel wide: its area is right to a part of that edge's curvature.
        let disc = sum(&drawn(|canvas| canvas.disc([6.0, 5.0], 4.0, [255; 3], 1.0)));
        assert!((disc - 16.0 * std::f64::consts::PI).abs() < 1.0, "{disc}");
        let triangle = [[1.0, 1.0], [9.0, 1.0], [1.0, 9.0]];
        let area = sum(&drawn(|canvas| canvas.polygon(&triangle, [255; 3], 1.0)));
        assert!((area - 32.0).abs() < 1.0, "{area}");
        let line = sum(&drawn(|canvas| canvas.stroke(&[[2.0, 5.0], [10.0, 5.0]], 2.0, [255; 3])));
        // Eight pixels in two rows, and the round ends.
        assert!((line - 16.0 - std::f64::consts::PI).abs() < 1.0, "{line}");
        let half = sum(&drawn(|canvas| canvas.rectangle([[2.0, 2.0], [6.0, 5.0]], [255; 3], 0.5)));
        assert!((half - 6.0).abs() < 0.1, "{half}");
    }

    #[test]
    fn nothing_is_drawn_outside_its_part() {
        let gray = drawn(|canvas| {
            canvas.fill([9; 3]);
            for at in [[-50.0, 3.0], [1e300, -1e300], [f64::NAN, 2.0], [f64::INFINITY, f64::NEG_INFINITY]] {
                canvas.disc(at, 60.0, [255; 3], 1.0);
                canvas.ring(at, 3.0, 1.0, [255; 3]);
                canvas.stroke(&[at, [4.0, 4.0]], 3.0, [255; 3]);
                canvas.polygon(&[at, [4.0, 4.0], [9.0, 1.0]], [255; 3], 1.0);
            }
        });
        for (i, gray) in gray.iter().enumerate() {
            let inside = (4..16).contains(&(i % 20)) && (2..12).contains(&(i / 20));
            assert_eq!(*gray > 0, inside, "{i}");
        }
    }
}
