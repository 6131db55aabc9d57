
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
