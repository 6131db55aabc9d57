
// The confidence of a flow, from its standard error. Arguments: the mean of AᵀA over its pixels, the mean square of the
// residual of Δb, and the share that both frames show.

// The squared residual of Δb that rounding to whole gray levels causes in an image without motion.
const NOISE = 0.001;
// The error that halves the confidence, in pixels.
const HALF = 0.25;
// Keeps an error off infinity where there is no texture at all.
const SMALLEST = 1e-6;

fn confidence_of(g_xx: vec4f, g_xy: vec4f, g_yy: vec4f, rest: vec4f, coverage: vec4f) -> vec4f {
    let half_difference = 0.5 * (g_xx - g_yy);
    let weakest = 0.5 * (g_xx + g_yy) - sqrt(half_difference * half_difference + g_xy * g_xy);
    let error = sqrt((rest + NOISE) / max(weakest, vec4f(SMALLEST)));
    return clamp(coverage, vec4f(), vec4f(1.0)) * HALF / (HALF + error);
}

// The confidence of a flow along a direction e, of any length but 0: from the error's variance there, eᵀG⁻¹e over e².
fn confidence_along(g: vec3f, rest: f32, coverage: f32, e: vec2f) -> f32 {
    let ridge = 1e-3 * (g.x + g.z) + SMALLEST;
    let xx = g.x + ridge;
    let yy = g.z + ridge;
    let spread = (e.x * e.x * yy - 2.0 * e.x * e.y * g.y + e.y * e.y * xx) / (dot(e, e) * (xx * yy - g.y * g.y));
    let error = sqrt((rest + NOISE) * spread);
    return clamp(coverage, 0.0, 1.0) * HALF / (HALF + error);
}
