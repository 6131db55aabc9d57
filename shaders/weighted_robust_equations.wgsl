// Each pixel's equations for the increment of its displacement, as in robust_equations.wgsl, weighted by the certainty of both
// frames' expansions.

struct Params {
    width: u32,
    height: u32,
    kappa: f32,  // share of its Hessian by which an expansion is continued to a place between pixels
    floor: f32,  // added to the squared slope that divides an equation
    robust: f32, // square of the residual up to which the weight is nearly constant; 0 for equal weights
    outside: f32, // weight of a place outside the second frame: 1 or 0
    border: f32, // 1 to weight pixels near the border less
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad_0: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term_0: array<f32>;
@group(0) @binding(3) var<storage, read> certainty_0: array<f32>;
@group(0) @binding(4) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(5) var<storage, read> cross_term_1: array<f32>;
@group(0) @binding(6) var<storage, read> certainty_1: array<f32>;
@group(0) @binding(7) var<storage, read> flow: array<f32>;
@group(0) @binding(8) var<storage, read_write> equations: array<f32>; // channels: G_xx, G_xy, G_yy, q_x, q_y

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let i = y * stride + x;
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let there = weighted_second_at(vec2f(f32(x), f32(y)) + d, params.kappa);
    let inside = there.second.inside;
    let m = model(Expansion(quad_0[i], cross_term_0[i]), there.second, vec2f());
    // A place outside counts with the pixel's certainty; otherwise halving all certainty would double its weight.
    let own = certainty_0[i];
    let certainty = own * select(own, there.certainty, inside);
    let outside = select(params.outside, 1.0, inside);
    // Equations without certainty are left out.
    store_equations(id.xy, robust_equations(id.xy, slope_residual(m), certainty * outside, certainty > 1e-6));
}

fn cross_term_of(i: u32) -> f32 {
    return cross_term_1[i];
}

fn certainty_of(i: u32) -> f32 {
    return certainty_1[i];
}
