// How far the two frames' expansions are from agreeing under a flow, in pixels.

struct Params {
    width: u32,
    height: u32,
    kappa: f32, // share of its Hessian by which an expansion is continued to a place between pixels
    floor: f32, // added to the squared slope that divides an equation
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad_0: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term_0: array<f32>;
@group(0) @binding(3) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(4) var<storage, read> cross_term_1: array<f32>;
@group(0) @binding(5) var<storage, read> certainty: array<f32>;
@group(0) @binding(6) var<storage, read> flow: array<f32>;
@group(0) @binding(7) var<storage, read_write> squared_misfit: array<f32>;
@group(0) @binding(8) var<storage, read_write> agreement: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let i = y * stride + x;
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let second = continued_second_at(vec2f(f32(x), f32(y)) + d, params.kappa);
    let m = model(Expansion(quad_0[i], cross_term_0[i]), second, vec2f());
    let e = slope_residual(m);
    // NaN is as large as can be.
    let s = select(9.0, e.s, e.s < 9.0);
    let share = select(0.0, certainty[i], second.inside);
    if id.x < stride && id.y < params.height {
        squared_misfit[id.y * stride + id.x] = 9.0 - share * (9.0 - s);
        let texture = e.h.x * e.h.x + 2.0 * (e.h.y * e.h.y) + e.h.z * e.h.z;
        // A texture without bounds, after overflow, is none.
        let seen = select(0.0, texture / (texture + 0.05), texture <= 1e30);
        agreement[id.y * stride + id.x] = share * seen * (1.0 - 0.5 * min(sqrt(s), 2.0));
    }
}
