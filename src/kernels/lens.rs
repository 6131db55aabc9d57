//! Shared by the kernels that read a raw image: the lens, and bilinear sampling.

/// The place at which the lens shows what an ideal pinhole shows at (x, y), both in the plane at unit distance (Brown
/// 1971 with a rational radial factor). `a` is k1 k2 p1 p2, `b` is k3 k4 k5 k6.
#[inline(always)]
pub(super) fn distort([x, y]: [f32; 2], a: [f32; 4], b: [f32; 4]) -> [f32; 2] {
    let ([k1, k2, p1, p2], [k3, k4, k5, k6]) = (a, b);
    let s = x * x + y * y;
    let numerator = 1.0 + s * (k1 + s * (k2 + s * k3));
    let denominator = 1.0 + s * (k4 + s * (k5 + s * k6));
    let q = numerator / denominator;
    [x * q + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x), y * q + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y]
}

/// A coordinate clamped to the range 0 to `last`. NaN becomes 0.
#[inline(always)]
pub(super) fn clamp_to_frame(place: f32, last: f32) -> f32 {
    if place > 0.0 { place.min(last) } else { 0.0 }
}

/// Samples a plane bilinearly, at a place that is clamped to it. `value` is applied to each pixel first.
#[inline(always)]
pub(super) fn bilinear(
    plane: &[f32],
    (width, height, stride): (usize, usize, usize),
    [x, y]: [f32; 2],
    value: impl Fn(f32) -> f32,
) -> f32 {
    let (x, y) = (clamp_to_frame(x, (width - 1) as f32), clamp_to_frame(y, (height - 1) as f32));
    let (left, above) = (x as usize, y as usize);
    let (right, below) = ((left + 1).min(width - 1), (above + 1).min(height - 1));
    let (along, down) = (x - left as f32, y - above as f32);
    let mix = |a: f32, b: f32, share: f32| a * (1.0 - share) + b * share;
    let row = |y: usize| mix(value(plane[y * stride + left]), value(plane[y * stride + right]), along);
    mix(row(above), row(below), down)
}
