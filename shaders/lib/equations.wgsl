
// One pixel's contribution to the normal equations of its displacement, from the two frames' polynomial expansions.
// Farnebäck 2003, section 3: A = (A1 + A2)/2, Δb = −(b2 − b1)/2 + A d, and Σ AᵀA d = Σ AᵀΔb.

struct Expansion {
    quad: vec4f, // b_x, b_y, A_xx, A_yy
    cross_term: f32, // 2 A_xy
}

// The expansion at a place: the weighted mean of the four pixels around it.
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

// AᵀA of a symmetric A: xx, xy, yy.
fn squared(a: vec3f) -> vec3f {
    return vec3f(a.x * a.x + a.y * a.y, (a.x + a.z) * a.y, a.z * a.z + a.y * a.y);
}

// The weights of pixels near the border: 0.14, 0.14, 0.4472, 0.4472, 0.4472, then 1.
fn border_weight(i: u32, n: u32) -> f32 {
    let far = n - 1u - i;
    return step_weight(i) * step_weight(far);
}

fn step_weight(distance: u32) -> f32 {
    return select(select(1.0, 0.4472, distance < 5u), 0.14, distance < 2u);
}
