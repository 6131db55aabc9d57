//! The demo's pair: its flow and the error.

use image::RgbImage;
use image::imageops::thumbnail;

use crate::error::Result;
use crate::eval::FlowError;
use crate::frame::{FlowField, Image, PixelFormat, Size};
use crate::io::picture;
use crate::report::colour_wheel;
use crate::report::html::{data_uri, figure, figures};

/// The largest width of an image in the page.
const WIDEST: u32 = 640;
const QUALITY: u8 = 85;

/// The flow of a pair of images with known motion. All images are 8-bit gray or RGB.
#[derive(Clone, Debug)]
pub struct DemoPair {
    /// The two images.
    pub frames: [Image; 2],
    /// The computed flow as arrows over the first image.
    pub arrows: Image,
    /// The computed flow as colours.
    pub flow: Image,
    /// The true flow as colours, to the same scale.
    pub truth: Image,
    /// The displacement in full colour, pixels.
    pub scale_px: f32,
    /// The endpoint error as gray levels: 0 is black, `white_px` white.
    pub error: Image,
    /// The endpoint error that is white, pixels.
    pub white_px: f32,
    /// The error of the computed flow against the true flow.
    pub accuracy: FlowError,
    /// The adapter that computed the flow, as text for people.
    pub adapter: String,
    /// The time per frame in a stream: median and longest, milliseconds.
    pub frame_ms: [f64; 2],
}

impl DemoPair {
    pub(super) fn html(&self) -> Result<String> {
        let e = &self.accuracy;
        let scale = format!("{:.1} px", self.scale_px);
        let pictures = [
            (&self.frames[0], "The first image".to_owned(), "The first image: gray texture and a disc"),
            (&self.frames[1], "The second image".to_owned(), "The second image, a little later"),
            (
                &self.arrows,
                "The computed flow as arrows".to_owned(),
                "Arrows over the first image, one every 16 pixels",
            ),
            (
                &self.flow,
                format!("The computed flow as colours, full at {scale}"),
                "Computed flow as colours: the hue is the direction, the saturation the length",
            ),
            (
                &self.truth,
                "The true flow, on the same scale".to_owned(),
                "True flow as colours, to compare with the computed one",
            ),
            (
                &self.error,
                format!("Endpoint error: 0 is black, {} px or more white", self.white_px),
                "Endpoint error of the computed flow: brighter is larger",
            ),
        ];
        let mut html = String::from("<div class=\"pictures\">\n");
        for (image, caption, alt) in &pictures {
            html += &embedded(image, alt, caption)?;
        }
        html += "</div>\n";
        let rows = [
            ("mean endpoint error", format!("{:.4} px", e.aee_px)),
            ("mean angular error", format!("{:.3}°", e.aae_deg)),
            ("error over 1 px", format!("{:.2} % of {} pixels", 100.0 * e.r1, e.pixels)),
        ];
        let about = format!("The colour of each direction; the rim is {scale}.");
        let key = embedded(&wheel()?, "The colour wheel of directions", &about)?;
        html += &format!("<div class=\"result\">\n{}{key}</div>\n", figures(&rows));
        Ok(html)
    }
}

/// An image embedded in the page.
fn embedded(image: &Image, alt: &str, caption: &str) -> Result<String> {
    let image = shrunk(image);
    let uri = data_uri("image/jpeg", &picture::encode_jpeg(&image, QUALITY)?);
    Ok(figure(&uri, image.size, alt, caption))
}

/// The image as RGB, at most [`WIDEST`] pixels wide.
fn shrunk(image: &Image) -> Image {
    let Size { width, height } = image.size;
    let data: Vec<u8> = match image.format {
        PixelFormat::Gray8 => image.data.iter().flat_map(|gray| [*gray; 3]).collect(),
        _ => image.data.clone(),
    };
    let whole = RgbImage::from_raw(width, height, data).unwrap_or_default();
    let (whole, size) = match width {
        ..=WIDEST => (whole, image.size),
        _ => {
            let size = Size::new(WIDEST, (height * WIDEST / width).max(1));
            (thumbnail(&whole, size.width, size.height), size)
        }
    };
    Image { size, format: PixelFormat::Rgb8, data: whole.into_raw() }
}

/// The colours of all directions, with full saturation at the rim.
fn wheel() -> Result<Image> {
    const SIDE: u32 = 120;
    let centre = 0.5 * (SIDE - 1) as f32;
    let off = |at: u32| (at as f32 - centre) / centre;
    let rows = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [off(x), off(y)]));
    // White beyond the rim.
    let inside = |uv: [f32; 2]| if uv[0].hypot(uv[1]) <= 1.0 { uv } else { [0.0; 2] };
    let flow = FlowField { size: Size::new(SIDE, SIDE), data: rows.map(inside).collect() };
    Ok(colour_wheel(&flow, Some(1.0))?.0)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::report::demo) fn gray(size: Size) -> Image {
        Image { size, format: PixelFormat::Gray8, data: (0..size.pixels()).map(|i| i as u8).collect() }
    }

    #[test]
    fn wide_pictures_are_shrunk_in_their_shape() {
        let size = |width, height| shrunk(&gray(Size::new(width, height))).size;
        assert_eq!(size(640, 9), Size::new(640, 9));
        assert_eq!(size(1280, 720), Size::new(640, 360));
        assert_eq!(size(2000, 1), Size::new(640, 1));
    }
}
