
// The common model of the two frames at a pixel.

struct Second {
    expansion: Expansion,
    inside: bool, // whether there are four pixels around the place; if not, the expansion is without meaning
}

// Where the second frame has no expansion, the first one's is used alone and contains no motion: b2 = b1 = 0.
fn model(first: Expansion, second: Second, flow: vec2f) -> Model {
    let other = second.expansion;
    let a_xx = select(first.quad.z, 0.5 * (first.quad.z + other.quad.z), second.inside);
    let a_yy = select(first.quad.w, 0.5 * (first.quad.w + other.quad.w), second.inside);
    let a_xy = select(0.5 * first.cross_term, 0.25 * (first.cross_term + other.cross_term), second.inside);
    let b_x = 0.5 * (first.quad.x - select(0.0, other.quad.x, second.inside));
    let b_y = 0.5 * (first.quad.y - select(0.0, other.quad.y, second.inside));
    return Model(
        vec3f(a_xx, a_xy, a_yy),
        vec2f(b_x + a_xx * flow.x + a_xy * flow.y, b_y + a_xy * flow.x + a_yy * flow.y),
    );
}
