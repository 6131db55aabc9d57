
// Bilinear sampling of the frame of in_width × in_height that params describe.

struct Between {
    left: u32,
    right: u32,
    above: u32, // first values of the two rows
    below: u32,
    fraction: vec2f,
}

// The four pixels around a place, which is clamped to the frame. NaN becomes 0.
fn between(place: vec2f) -> Between {
    let stride = (params.in_width + 3u) / 4u * 4u;
    let last = vec2f(f32(params.in_width - 1u), f32(params.in_height - 1u));
    let clamped = clamp_to_frame(place, last);
    let whole = floor(clamped);
    let at = vec2u(whole);
    return Between(
        at.x,
        min(at.x + 1u, params.in_width - 1u),
        at.y * stride,
        min(at.y + 1u, params.in_height - 1u) * stride,
        clamped - whole,
    );
}

// A place clamped to the range 0 to last.
fn clamp_to_frame(place: vec2f, last: vec2f) -> vec2f {
    return select(vec2f(), min(place, last), place > vec2f());
}
