//! Letters and digits for pictures, 3×5 dots each.

use crate::frame::Image;

/// Dots from one character to the next.
const ADVANCE: usize = 4;
/// Dots of a character's height.
const HEIGHT: usize = 5;

/// Writes digits, letters (in capitals) and some signs, with black around them, on a picture of
/// [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8). A dot is `scale` pixels wide; the first one's upper left corner
/// is at `at`, or as near to it as all of the text fits in. What has no glyph is a blank.
pub(super) fn text(image: &mut Image, at: [f64; 2], text: &str, colour: [u8; 3], scale: usize) {
    let (width, height) = (image.size.width as usize, image.size.height as usize);
    let room = [scale * (ADVANCE * text.chars().count() + 1), scale * (HEIGHT + 2)];
    let fit = |at: f64, room: usize, side: usize| (at.max(0.0) as usize).min(side.saturating_sub(room));
    let [left, top] = [fit(at[0], room[0], width), fit(at[1], room[1], height)];
    let glyphs: Vec<[u8; HEIGHT]> = text.chars().map(glyph).collect();
    for y in 0..room[1].min(height) {
        for x in 0..room[0].min(width) {
            // A dot of black on each side.
            let dot = |pixel: usize| (pixel / scale).wrapping_sub(1);
            let glyph = glyphs.get(dot(x) / ADVANCE);
            let row = glyph.and_then(|glyph| glyph.get(dot(y))).copied().unwrap_or(0);
            let lit = dot(x) < ADVANCE * glyphs.len() && row << (dot(x) % ADVANCE) & 0b100 != 0;
            let pixel = 3 * ((top + y) * width + left + x);
            image.data[pixel..pixel + 3].copy_from_slice(if lit { &colour } else { &[0; 3] });
        }
    }
}

/// A character's rows, the leftmost dot in the third bit.
fn glyph(character: char) -> [u8; HEIGHT] {
    match character.to_ascii_uppercase() {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        '.' => [0b000, 0b000, 0b000, 0b000, 0b010],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        '+' => [0b000, 0b010, 0b111, 0b010, 0b000],
        ':' => [0b000, 0b010, 0b000, 0b010, 0b000],
        '/' => [0b001, 0b001, 0b010, 0b100, 0b100],
        '°' => [0b010, 0b101, 0b010, 0b000, 0b000],
        ',' => [0b000, 0b000, 0b000, 0b010, 0b100],
        '%' => [0b101, 0b001, 0b010, 0b100, 0b101],
        '(' => [0b001, 0b010, 0b010, 0b010, 0b001],
        ')' => [0b100, 0b010, 0b010, 0b010, 0b100],
        'A' => [0b010, 0b101, 0b111, 0b101, 0b101],
        'B' => [0b110, 0b101, 0b110, 0b101, 0b110],
        'C' => [0b011, 0b100, 0b100, 0b100, 0b011],
        'D' => [0b110, 0b101, 0b101, 0b101, 0b110],
        'E' => [0b111, 0b100, 0b110, 0b100, 0b111],
        'F' => [0b111, 0b100, 0b110, 0b100, 0b100],
        'G' => [0b011, 0b100, 0b101, 0b101, 0b011],
        'H' => [0b101, 0b101, 0b111, 0b101, 0b101],
        'I' => [0b111, 0b010, 0b010, 0b010, 0b111],
        'J' => [0b001, 0b001, 0b001, 0b101, 0b010],
        'K' => [0b101, 0b101, 0b110, 0b101, 0b101],
        'L' => [0b100, 0b100, 0b100, 0b100, 0b111],
        'M' => [0b101, 0b111, 0b111, 0b101, 0b101],
        'N' => [0b110, 0b101, 0b101, 0b101, 0b101],
        'O' => [0b010, 0b101, 0b101, 0b101, 0b010],
        'P' => [0b110, 0b101, 0b110, 0b100, 0b100],
        'Q' => [0b010, 0b101, 0b101, 0b111, 0b011],
        'R' => [0b110, 0b101, 0b110, 0b101, 0b101],
        'S' => [0b011, 0b100, 0b010, 0b001, 0b110],
        'T' => [0b111, 0b010, 0b010, 0b010, 0b010],
        'U' => [0b101, 0b101, 0b101, 0b101, 0b111],
        'V' => [0b101, 0b101, 0b101, 0b101, 0b010],
        'W' => [0b101, 0b101, 0b111, 0b111, 0b101],
        'X' => [0b101, 0b101, 0b010, 0b101, 0b101],
        'Y' => [0b101, 0b101, 0b010, 0b010, 0b010],
        'Z' => [0b111, 0b001, 0b010, 0b100, 0b111],
        _ => [0; HEIGHT],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, Size};

    fn written(size: Size, at: [f64; 2], characters: &str) -> Vec<String> {
        let mut image = Image { size, format: PixelFormat::Rgb8, data: vec![9; 3 * size.pixels()] };
        text(&mut image, at, characters, [255; 3], 1);
        let sign = |pixel: &[u8]| match pixel[0] {
            255 => '#',
            0 => '.',
            _ => ' ',
        };
        let rows = image.data.chunks_exact(3 * size.width as usize);
        rows.map(|row| row.chunks_exact(3).map(sign).collect()).collect()
    }

    #[test]
    fn digits_look_like_digits() {
        let expected = [
            "         ",
            ".........",
            "..#..###.",
            ".##....#.",
            "..#...#..",
            "..#...#..",
            ".###..#..",
            ".........",
        ];
        assert_eq!(written(Size::new(9, 8), [0.0, 1.0], "17"), expected);
    }

    #[test]
    fn text_stays_inside() {
        for at in [[-9.0, 1e9], [f64::NAN, f64::INFINITY], [100.0, -1.0]] {
            let rows = written(Size::new(10, 8), at, "17");
            assert_eq!(rows.concat().matches('#').count(), 15, "{at:?}");
            written(Size::new(3, 2), at, "0.5s");
        }
    }
}
