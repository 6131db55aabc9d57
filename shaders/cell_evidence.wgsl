// The evidence of each cell's flow: means over samples of the two frames' expansions.

struct Params {
    columns: u32,
    rows: u32,
    width: u32,
    height: u32,
    cell: u32, // side of a cell, pixels
    step: u32, // distance of samples, pixels
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad_0: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term_0: array<f32>;
@group(0) @binding(3) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(4) var<storage, read> cross_term_1: array<f32>;
@group(0) @binding(5) var<storage, read> certainty_0: array<f32>;
@group(0) @binding(6) var<storage, read> certainty_1: array<f32>;
@group(0) @binding(7) var<storage, read> flow: array<f32>;
// Channels: AᵀA (xx, xy, yy), the square of the residual of Δb, the share that both frames show.
@group(0) @binding(8) var<storage, read_write> evidence: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_SIDE = 64u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let out_stride = (params.columns + 3u) / 4u * 4u;
    let cell = min(id.xy, vec2u(params.columns, params.rows) - 1u);
    let size = vec2u(params.width, params.height);
    var count = 0.0;
    var g = vec3f();
    var rest = 0.0;
    var coverage = 0.0;
    for (var j = 0u; j < min(params.cell, MAX_SIDE); j += params.step) {
        for (var i = 0u; i < min(params.cell, MAX_SIDE); i += params.step) {
            let pixel = cell * params.cell + vec2u(i, j);
            let at = min(pixel, size - 1u);
            let base = 2u * at.y * stride + at.x;
            let place = vec2f(at) + vec2f(flow[base], flow[base + stride]);
            let second = second_at(place);
            let here = at.y * stride + at.x;
            let m = model(Expansion(quad_0[here], cross_term_0[here]), second, vec2f());
            let there = vec2u(select(vec2f(), place, second.inside));
            let shown = certainty_0[here] * certainty_1[there.y * stride + there.x];
            let share = select(0.0, shown, second.inside && all(pixel < size));
            let sample = squared(share * m.a);
            let b = share * m.delta_b;
            let known = dot(abs(sample), vec3f(1.0)) + dot(b, b) <= 1e30;
            count += select(0.0, 1.0, all(pixel < size));
            g += select(vec3f(), sample, known);
            rest += select(0.0, dot(b, b), known);
            coverage += select(0.0, share, known);
        }
    }
    let n = 1.0 / count;
    if id.x < out_stride && id.y < params.rows {
        let out = 5u * id.y * out_stride + id.x;
        evidence[out] = g.x * n;
        evidence[out + out_stride] = g.y * n;
        evidence[out + 2u * out_stride] = g.z * n;
        evidence[out + 3u * out_stride] = rest * n;
        evidence[out + 4u * out_stride] = coverage * n;
    }
}
