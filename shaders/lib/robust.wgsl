
// A pixel's equations G δ = q.
struct PixelEquations {
    g: vec3f, // xx, xy, yy
    q: vec2f,
}

// A pixel's equations with their robust weight times `weight`; zeros where they are not `known`.
fn robust_equations(id: vec2u, e: SlopeResidual, weight: f32, known: bool) -> PixelEquations {
    let robust = select(1.0, inverseSqrt(e.s + params.robust), params.robust > 0.0);
    let edge = border_weight(min(id.x, params.width - 1u), params.width)
        * border_weight(min(id.y, params.height - 1u), params.height);
    let border = 1.0 + params.border * (edge * edge - 1.0);
    let w = weight * border * robust * e.n;
    let g = w.x * e.h.x * e.h.xy + w.y * e.h.y * e.h.yz;
    let g_yy = w.x * e.h.y * e.h.y + w.y * e.h.z * e.h.z;
    let q = w.x * e.r.x * e.h.xy + w.y * e.r.y * e.h.yz;
    return finite_equations(PixelEquations(vec3f(g, g_yy), q), known);
}

// Equations without overflow or NaN: zeros in their place, so that they do not spread.
fn finite_equations(e: PixelEquations, known: bool) -> PixelEquations {
    let finite = known && dot(abs(e.g), vec3f(1.0)) + dot(abs(e.q), vec2f(1.0)) <= 1e30;
    return PixelEquations(select(vec3f(), e.g, finite), select(vec2f(), e.q, finite));
}

fn store_equations(id: vec2u, e: PixelEquations) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        equations[at] = e.g.x;
        equations[at + stride] = e.g.y;
        equations[at + 2u * stride] = e.g.z;
        equations[at + 3u * stride] = e.q.x;
        equations[at + 4u * stride] = e.q.y;
    }
}
