
// Reading between the pixels of the frame of in_width × in_height that params describe.

struct Between {
    left: u32,
    right: u32,
    above: u32, // first values of the two rows
    below: u32,
    fraction: vec2f,
}

// The four pixels around a place, which is held within the frame. What is not a number is held at 0.
fn between(place: vec2f) -> Between {
    let stride = (params.in_width + 3u) / 4u * 4u;
    let last = vec2f(f32(params.in_width - 1u), f32(params.in_height - 1u));
    let held = hold(place, last);
    let whole = floor(held);
    let at = vec2u(whole);
    return Between(
        at.x,
        min(at.x + 1u, params.in_width - 1u),
        at.y * stride,
        min(at.y + 1u, params.in_height - 1u) * stride,
        held - whole,
    );
}

// A place held within 0 to last.
fn hold(place: vec2f, last: vec2f) -> vec2f {
    return select(vec2f(), min(place, last), place > vec2f());
}
