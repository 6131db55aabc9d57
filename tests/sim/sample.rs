//! Interpolation of images.

use viewsphere::frame::Image;

/// Catmull–Rom interpolation; `None` within two pixels of the border.
pub(crate) fn sample(image: &Image, at: [f64; 2]) -> Option<f64> {
    let (width, height) = (image.size.width as usize, image.size.height as usize);
    let inside = |c: f64, side: usize| c >= 2.0 && c <= side as f64 - 4.0;
    if !(inside(at[0], width) && inside(at[1], height)) {
        return None;
    }
    let weights = |t: f64| {
        [
            ((-0.5 * t + 1.0) * t - 0.5) * t,
            (1.5 * t - 2.5) * t * t + 1.0,
            ((-1.5 * t + 2.0) * t + 0.5) * t,
            (0.5 * t - 0.5) * t * t,
        ]
    };
    let [x, y] = at.map(|c| c.floor() as usize);
    let (columns, rows) = (weights(at[0].fract()), weights(at[1].fract()));
    let pixel = |i: usize, j: usize| f64::from(image.data[(y + j - 1) * width + x + i - 1]);
    Some((0..4).map(|j| rows[j] * (0..4).map(|i| columns[i] * pixel(i, j)).sum::<f64>()).sum())
}
