
// The lens: Brown 1971 with a rational radial factor, in OpenCV's order of the coefficients.

// The place at which the lens shows what an ideal pinhole shows at (x, y), both in the plane at unit distance.
// a: k1 k2 p1 p2, b: k3 k4 k5 k6.
fn distort(ideal: vec2f, a: vec4f, b: vec4f) -> vec2f {
    let x = ideal.x;
    let y = ideal.y;
    let s = x * x + y * y;
    let numerator = 1.0 + s * (a.x + s * (a.y + s * b.x));
    let denominator = 1.0 + s * (b.y + s * (b.z + s * b.w));
    let q = numerator / denominator;
    return vec2f(
        x * q + 2.0 * a.z * x * y + a.w * (s + 2.0 * x * x),
        y * q + a.z * (s + 2.0 * y * y) + 2.0 * a.w * x * y,
    );
}
