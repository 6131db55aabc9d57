//! The first line of a YUV4MPEG2 stream.

use std::path::Path;

use super::read::header_size;
use crate::error::{Error, Result};
use crate::frame::Size;

pub(super) const MAGIC: &str = "YUV4MPEG2";

const KNOWN: &str = "mono, 411, 420, 422 or 444, with 8 to 16 bits";

#[derive(Debug, PartialEq)]
pub(super) struct Header {
    pub(super) size: Size,
    /// Frames and seconds, both over 0.
    pub(super) rate: Option<(u32, u32)>,
    /// Bits per sample, 8 to 16.
    pub(super) depth: u32,
    chroma: Chroma,
}

/// The number of chroma planes, and their size relative to the luma.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chroma {
    planes: u64,
    across: u32,
    down: u32,
}

impl Header {
    /// Parses the text after the magic word, up to the end of the line.
    pub(super) fn parse(path: &Path, line: &str) -> Result<Self> {
        let (mut width, mut height, mut rate) = (None, None, None);
        // The specification's default, which old writers rely on.
        let mut space = "420";
        for word in line.split(' ').filter(|word| !word.is_empty()) {
            let mut rest = word.chars();
            match (rest.next(), rest.as_str()) {
                (Some('W'), value) => width = Some(side(path, "width", value)?),
                (Some('H'), value) => height = Some(side(path, "height", value)?),
                (Some('F'), value) => rate = fraction(path, value)?,
                (Some('C'), value) => space = value,
                // Interlacing, pixel aspect and comments do not affect the luma.
                (Some('I' | 'A' | 'X'), _) => {}
                _ => {
                    let found: String = word.chars().take(40).collect();
                    return Err(Error::format(
                        path,
                        "header word",
                        format!("{found:?}"),
                        "W, H, F, I, A, C or X",
                    ));
                }
            }
        }
        let missing = |what| Error::format(path, what, "missing", "a number in the header");
        let width = width.ok_or_else(|| missing("width"))?;
        let height = height.ok_or_else(|| missing("height"))?;
        let size = header_size(path, width, height)?;
        let (chroma, depth) = colour_space(space).ok_or_else(|| {
            let found: String = space.chars().take(40).collect();
            Error::format(path, "colour space", format!("{found:?}"), KNOWN)
        })?;
        Ok(Self { size, rate, depth, chroma })
    }

    /// Samples of all chroma and alpha planes of a frame.
    pub(super) fn chroma_samples(&self) -> u64 {
        let Chroma { planes, across, down } = self.chroma;
        planes * u64::from(self.size.width.div_ceil(across)) * u64::from(self.size.height.div_ceil(down))
    }
}

fn side(path: &Path, what: &'static str, value: &str) -> Result<i64> {
    let wrong = || Error::format(path, what, format!("{value:?}"), "a whole number");
    value.parse::<u32>().map(i64::from).map_err(|_| wrong())
}

/// Parses a fraction such as `30000:1001`; `0:0` is an unknown rate.
fn fraction(path: &Path, value: &str) -> Result<Option<(u32, u32)>> {
    let pair = value.split_once(':').and_then(|(n, d)| Some((n.parse().ok()?, d.parse().ok()?)));
    match pair {
        Some((0, 0)) => Ok(None),
        Some((frames, seconds)) if frames > 0 && seconds > 0 => Ok(Some((frames, seconds))),
        _ => Err(Error::format(path, "frame rate", format!("{value:?}"), "a fraction such as 30000:1001")),
    }
}

fn colour_space(name: &str) -> Option<(Chroma, u32)> {
    let chroma = |planes, across, down| Chroma { planes, across, down };
    // The three chroma positions of 4:2:0 do not affect the luma.
    let fixed = match name {
        "420" | "420jpeg" | "420paldv" | "420mpeg2" => Some(chroma(2, 2, 2)),
        "411" => Some(chroma(2, 4, 1)),
        "422" => Some(chroma(2, 2, 1)),
        "444" => Some(chroma(2, 1, 1)),
        "444alpha" => Some(chroma(3, 1, 1)),
        "mono" => Some(chroma(0, 1, 1)),
        _ => None,
    };
    if let Some(chroma) = fixed {
        return Some((chroma, 8));
    }
    let (chroma, depth) = [
        ("420p", chroma(2, 2, 2)),
        ("422p", chroma(2, 2, 1)),
        ("444p", chroma(2, 1, 1)),
        ("mono", chroma(0, 1, 1)),
    ]
    .into_iter()
    .find_map(|(prefix, chroma)| Some((chroma, name.strip_prefix(prefix)?)))?;
    let depth = depth.parse().ok().filter(|depth| (9..=16).contains(depth))?;
    Some((chroma, depth))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Header> {
        Header::parse(Path::new("a.y4m"), line)
    }

    #[test]
    fn size_rate_depth_and_chroma_are_found() {
        let header = parse(" W641 H363 F30000:1001 Ip A0:0 C422p10 XYSCSS=422P10").unwrap();
        assert_eq!((header.size, header.rate, header.depth), (Size::new(641, 363), Some((30000, 1001)), 10));
        assert_eq!(header.chroma_samples(), 2 * 321 * 363);
        assert_eq!(parse(" W3 H3").unwrap().chroma_samples(), 8);
        assert_eq!(parse(" W4 H4 F0:0 Cmono16").unwrap().rate, None);
        assert_eq!(parse(" W4 H4 Cmono16").unwrap().depth, 16);
        assert_eq!(parse(" W4 H4 Cmono16").unwrap().chroma_samples(), 0);
    }

    #[test]
    fn wrong_words_are_named() {
        let cases = [
            ("", "width is missing"),
            (" W4", "height is missing"),
            (" W4 Hx", "height is \"x\""),
            (" W-4 H4", "width is \"-4\""),
            (" W0 H4", "size is 0×4"),
            (" W16385 H4", "size is 16385×4"),
            (" W4294967295 H4294967295", "size is 4294967295×4294967295"),
            (" W4 H4 F30", "frame rate is \"30\""),
            (" W4 H4 F30:0", "frame rate is \"30:0\""),
            (" W4 H4 C420p17", "colour space is \"420p17\""),
            (" W4 H4 Crgb", "colour space is \"rgb\""),
            (" W4 H4 Zx", "header word is \"Zx\""),
        ];
        for (line, expected) in cases {
            let text = parse(line).unwrap_err().to_string();
            assert!(text.starts_with(&format!("a.y4m: {expected}")), "{line}: {text}");
        }
    }
}
