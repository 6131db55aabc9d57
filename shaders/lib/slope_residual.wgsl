
// How far the two equations H δ = r of a pixel are from holding without an increment, each divided by its own slope.
struct SlopeResidual {
    h: vec3f, // Hessian: xx, xy, yy
    r: vec2f, // difference of the slopes
    n: vec2f, // inverse of each equation's squared slope
    s: f32,   // sum of the squared residuals, in square pixels
}

fn slope_residual(m: Model) -> SlopeResidual {
    let h = 2.0 * m.a;
    let r = 2.0 * m.delta_b;
    let n = 1.0 / (vec2f(dot(h.xy, h.xy), dot(h.yz, h.yz)) + params.floor);
    return SlopeResidual(h, r, n, n.x * (r.x * r.x) + n.y * (r.y * r.y));
}
