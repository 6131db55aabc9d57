//! Text on images, in the fixed-width fonts of X11 from embedded-graphics.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{FONT_5X7, FONT_7X13, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::text::{Baseline, Text};

use crate::frame::Image;

/// The black margin around a text, in pixels of the font's own size.
const MARGIN: usize = 1;

/// Writes a line of text on black into an image of [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8). The text is
/// about 7 `scale` pixels high. Its upper left corner is at `at`, or as near to it as the whole text fits. Characters
/// that the fonts (ISO 8859-1) lack become question marks.
pub(super) fn text(image: &mut Image, at: [f64; 2], text: &str, colour: [u8; 3], scale: usize) {
    let (font, zoom) = font(scale);
    // Latin-1 lacks the minus sign and the dash.
    let text = text.replace(['\u{2212}', '–'], "-");
    let [width, height] = [image.size.width as usize, image.size.height as usize];
    let characters = text.chars().count();
    let letter = [font.character_size.width as usize, font.character_size.height as usize];
    let room = [characters * letter[0], letter[1]].map(|side| zoom * (side + 2 * MARGIN));
    let fit = |at: f64, room: usize, side: usize| (at.max(0.0) as usize).min(side.saturating_sub(room));
    let corner = [fit(at[0], room[0], width), fit(at[1], room[1], height)];
    for row in image.data.chunks_exact_mut(3 * width).skip(corner[1]).take(room[1]) {
        row[3 * corner[0]..3 * (corner[0] + room[0]).min(width)].fill(0);
    }
    let style = MonoTextStyle::new(font, Rgb888::new(colour[0], colour[1], colour[2]));
    let margin = Point::new(MARGIN as i32, MARGIN as i32);
    let text = Text::with_baseline(&text, margin, style, Baseline::Top);
    let Ok(_) = text.draw(&mut Enlarged { image, corner, zoom });
}

/// A font, and the width in pixels of one of its dots.
fn font(scale: usize) -> (&'static MonoFont<'static>, usize) {
    match scale {
        0 | 1 => (&FONT_5X7, 1),
        2 => (&FONT_7X13, 1),
        _ => (&FONT_10X20, scale / 3),
    }
}

/// A part of an image to draw on, with each dot as a square of pixels. Dots outside are clipped.
struct Enlarged<'a> {
    image: &'a mut Image,
    corner: [usize; 2],
    zoom: usize,
}

impl OriginDimensions for Enlarged<'_> {
    fn size(&self) -> Size {
        Size::new(self.image.size.width, self.image.size.height)
    }
}

impl DrawTarget for Enlarged<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let [width, height] = [self.image.size.width as usize, self.image.size.height as usize];
        for Pixel(Point { x, y }, colour) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { continue };
            let range = |corner: usize, dot: usize, side: usize| {
                let from = corner + self.zoom * dot;
                from.min(side)..(from + self.zoom).min(side)
            };
            let columns = range(self.corner[0], x, width);
            for row in range(self.corner[1], y, height) {
                let row = &mut self.image.data[3 * row * width..][..3 * width];
                for pixel in row.as_chunks_mut::<3>().0[columns.clone()].iter_mut() {
                    *pixel = [colour.r(), colour.g(), colour.b()];
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, Size};

    fn written(size: Size, at: [f64; 2], characters: &str, scale: usize) -> Vec<String> {
        let mut image = Image { size, format: PixelFormat::Rgb8, data: vec![9; 3 * size.pixels()] };
        text(&mut image, at, characters, [255; 3], scale);
        let sign = |pixel: &[u8]| match pixel[0] {
            255 => '#',
            0 => '.',
            _ => ' ',
        };
        let rows = image.data.chunks_exact(3 * size.width as usize);
        rows.map(|row| row.chunks_exact(3).map(sign).collect()).collect()
    }

    fn lit(size: Size, at: [f64; 2], characters: &str, scale: usize) -> usize {
        written(size, at, characters, scale).concat().matches('#').count()
    }

    #[test]
    fn digits_look_like_digits() {
        let expected = [
            "             ",
            "............ ",
            "...#..####.. ",
            "..##.....#.. ",
            "...#....#... ",
            "...#....#... ",
            "...#...#.... ",
            "..###..#.... ",
            "............ ",
            "............ ",
        ];
        assert_eq!(written(Size::new(13, 10), [0.0, 1.0], "17", 1), expected);
    }

    #[test]
    fn text_stays_inside() {
        let size = Size::new(130, 50);
        for scale in [1, 2, 3, 6] {
            let whole = lit(size, [0.0, 0.0], "17", scale);
            for at in [[-9.0, 1e9], [f64::NAN, f64::INFINITY], [1000.0, -1.0]] {
                assert_eq!(lit(size, at, "17", scale), whole, "{at:?} {scale}");
                written(Size::new(3, 2), at, "0.5 s", scale);
            }
        }
    }

    #[test]
    fn signs_of_figures_are_there() {
        let size = Size::new(40, 24);
        let unknown = written(size, [0.0; 2], "?", 3);
        for sign in "°±µ%+-–\u{2212}²/<>=_".chars() {
            assert_ne!(written(size, [0.0; 2], &sign.to_string(), 3), unknown, "{sign}");
        }
        assert_eq!(written(size, [0.0; 2], "→", 3), unknown);
        assert_eq!(lit(Size::new(80, 48), [0.0; 2], "8", 6), 4 * lit(size, [0.0; 2], "8", 3));
    }
}
