//! Smaller copies of images.

use crate::frame::{Image, Size};

/// The image, or every nth pixel and row of it, so that it is at most `widest` pixels wide. Colours stay those of single
/// pixels, which a mean of an error's colours would not.
pub fn thinned(image: &Image, widest: u32) -> Image {
    let Size { width, height } = image.size;
    let step = width.div_ceil(widest.max(1)).max(1);
    if step == 1 {
        return image.clone();
    }
    let size = Size::new(width.div_ceil(step), height.div_ceil(step));
    let bytes = image.format.bytes();
    let rows = image.data.chunks_exact(width as usize * bytes).step_by(step as usize);
    let data =
        rows.flat_map(|row| row.chunks_exact(bytes).step_by(step as usize).flatten()).copied().collect();
    Image { size, format: image.format, data }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::PixelFormat;

    #[test]
    fn every_nth_pixel_is_kept() {
        let data = (0..7 * 3).flat_map(|i| [i, 0, 0]).collect();
        let image = Image { size: Size::new(7, 3), format: PixelFormat::Rgb8, data };
        let small = thinned(&image, 4);
        assert!(small.frame().is_ok());
        let kept: Vec<u8> = small.data.iter().step_by(3).copied().collect();
        assert_eq!((small.size, kept), (Size::new(4, 2), vec![0, 2, 4, 6, 14, 16, 18, 20]));
        assert_eq!(thinned(&image, 7), image);
    }
}
