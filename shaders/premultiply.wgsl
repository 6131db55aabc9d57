// Multiplies an image by the certainty of its pixels, and clamps that certainty to its range.
// Knutsson and Westin 1993, normalised averaging: both are smoothed alike, and unknown pixels add nothing to either.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> gray: array<vec4f>;
@group(0) @binding(2) var<storage, read> certainty: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> weighted_gray: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> clamped_certainty: array<vec4f>;

const SPAN = vec2u(4u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let at = id.y * stride + min(id.x, stride - 1u);
    let x0 = id.x * SPAN.x;
    let f = gray[at];
    let c = certainty[at];
    // NaN compares as false with everything, so it is unknown.
    let known = (c > vec4f()) & (abs(f) <= vec4f(1e30));
    let clamped = select(vec4f(), min(c, vec4f(1.0)), known);
    let weighted = select(vec4f(), clamped * f, known);
    if id.x < stride && id.y < params.height {
        weighted_gray[at] = repeat_last(weighted, x0, params.width);
        clamped_certainty[at] = repeat_last(clamped, x0, params.width);
    }
}
