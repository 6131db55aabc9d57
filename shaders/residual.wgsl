// The residual of each pixel: how well the two frames' expansions agree under the estimated flow.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad_0: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term_0: array<f32>;
@group(0) @binding(3) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(4) var<storage, read> cross_term_1: array<f32>;
@group(0) @binding(5) var<storage, read> certainty: array<f32>;
@group(0) @binding(6) var<storage, read> flow: array<f32>;
@group(0) @binding(7) var<storage, read_write> evidence: array<f32>; // channels: G_xx, G_xy, G_yy, ‖Δb‖², coverage

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let i = y * stride + x;
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let second = second_at(vec2f(f32(x), f32(y)) + d);
    // The residual of Δb is the part that the flow does not explain.
    let m = model(Expansion(quad_0[i], cross_term_0[i]), second, vec2f());
    let share = select(0.0, certainty[i], second.inside);
    let weight = share * border_weight(x, params.width) * border_weight(y, params.height);
    let g = squared(weight * m.a);
    let b = weight * m.delta_b;
    let known = dot(abs(g), vec3f(1.0)) + dot(b, b) <= 1e30;
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        evidence[at] = select(0.0, g.x, known);
        evidence[at + stride] = select(0.0, g.y, known);
        evidence[at + 2u * stride] = select(0.0, g.z, known);
        evidence[at + 3u * stride] = select(0.0, dot(b, b), known);
        evidence[at + 4u * stride] = select(0.0, share, known);
    }
}
