
// Column and row of a window's sample.
fn offset(sample: u32) -> vec2i {
    // No processor divides whole numbers by the vector; half a sample keeps the quotient off whole numbers.
    let row = u32((f32(sample) + 0.5) / f32(params.window_width));
    return vec2i(vec2u(sample - row * params.window_width, row));
}
