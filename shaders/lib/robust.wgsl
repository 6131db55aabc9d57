
// Stores a pixel's equations with their robust weight times `weight`; zeros where they are not `known`.
fn store_equations(id: vec2u, e: SlopeResidual, weight: f32, known: bool) {
    let robust = select(1.0, inverseSqrt(e.s + params.robust), params.robust > 0.0);
    let edge = border_weight(min(id.x, params.width - 1u), params.width)
        * border_weight(min(id.y, params.height - 1u), params.height);
    let border = 1.0 + params.border * (edge * edge - 1.0);
    let w = weight * border * robust * e.n;
    let g = w.x * e.h.x * e.h.xy + w.y * e.h.y * e.h.yz;
    let g_yy = w.x * e.h.y * e.h.y + w.y * e.h.z * e.h.z;
    let q = w.x * e.r.x * e.h.xy + w.y * e.r.y * e.h.yz;
    // Overflow and NaN become zeros, so that they do not spread.
    let finite = known && abs(g.x) + abs(g.y) + abs(g_yy) + abs(q.x) + abs(q.y) <= 1e30;
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        equations[at] = select(0.0, g.x, finite);
        equations[at + stride] = select(0.0, g.y, finite);
        equations[at + 2u * stride] = select(0.0, g_yy, finite);
        equations[at + 3u * stride] = select(0.0, q.x, finite);
        equations[at + 4u * stride] = select(0.0, q.y, finite);
    }
}
