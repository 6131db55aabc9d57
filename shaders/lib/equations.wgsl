
// One pixel's contribution to the normal equations of its displacement, from the two frames' polynomial expansions.
// Farnebäck 2003, section 3: A = (A1 + A2)/2, Δb = −(b2 − b1)/2 + A d, and Σ AᵀA d = Σ AᵀΔb.

struct Expansion {
    quad: vec4f, // b_x, b_y, A_xx, A_yy
    cross_term: f32, // 2 A_xy
}

// The expansion between the four pixels around a place, by their weights.
fn bilinear(a: Expansion, b: Expansion, c: Expansion, d: Expansion, f: vec2f) -> Expansion {
    let w_a = (1.0 - f.x) * (1.0 - f.y);
    let w_b = f.x * (1.0 - f.y);
    let w_c = (1.0 - f.x) * f.y;
    let w_d = f.x * f.y;
    return Expansion(
        w_a * a.quad + w_b * b.quad + w_c * c.quad + w_d * d.quad,
        w_a * a.cross_term + w_b * b.cross_term + w_c * c.cross_term + w_d * d.cross_term,
    );
}

struct Model {
    a: vec3f,       // A_xx, A_xy, A_yy
    delta_b: vec2f, // Δb
}

// Where the second frame has no expansion, the first one's stands alone and says nothing of motion: b2 = b1 = 0.
fn model(first: Expansion, second: Expansion, inside: bool, flow: vec2f) -> Model {
    let a_xx = select(first.quad.z, 0.5 * (first.quad.z + second.quad.z), inside);
    let a_yy = select(first.quad.w, 0.5 * (first.quad.w + second.quad.w), inside);
    let a_xy = select(0.5 * first.cross_term, 0.25 * (first.cross_term + second.cross_term), inside);
    let b_x = 0.5 * (first.quad.x - select(0.0, second.quad.x, inside));
    let b_y = 0.5 * (first.quad.y - select(0.0, second.quad.y, inside));
    return Model(
        vec3f(a_xx, a_xy, a_yy),
        vec2f(b_x + a_xx * flow.x + a_xy * flow.y, b_y + a_xy * flow.x + a_yy * flow.y),
    );
}

// How much the pixels near the border count: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
fn border_weight(i: u32, n: u32) -> f32 {
    let far = n - 1u - i;
    return step_weight(i) * step_weight(far);
}

fn step_weight(distance: u32) -> f32 {
    return select(select(1.0, 0.4472, distance < 5u), 0.14, distance < 2u);
}
