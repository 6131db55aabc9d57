
// The second frame's expansion, sampled bilinearly from quad_1 and cross_term_1.

fn second_at(place: vec2f) -> Second {
    let stride = (params.width + 3u) / 4u * 4u;
    let whole = floor(place);
    // NaN is not inside either.
    let inside = all(whole >= vec2f()) && all(whole < vec2f(f32(params.width), f32(params.height)) - 1.0);
    let at = vec2u(select(vec2f(), whole, inside));
    let i = at.y * stride + at.x;
    // An image one pixel wide or high has no neighbours to read, and no place is inside it.
    let right = select(0u, 1u, inside);
    let below = select(0u, stride, inside);
    let expansion = bilinear(
        Expansion(quad_1[i], cross_term_1[i]),
        Expansion(quad_1[i + right], cross_term_1[i + right]),
        Expansion(quad_1[i + below], cross_term_1[i + below]),
        Expansion(quad_1[i + below + right], cross_term_1[i + below + right]),
        place - whole,
    );
    return Second(expansion, inside);
}
