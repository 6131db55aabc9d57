// The equations of a pair and of the frame before it. In that frame a pixel is at a multiple of its displacement.

struct Params {
    width: u32,
    height: u32,
    kappa: f32,  // share of its Hessian by which an expansion is continued to a place between pixels
    floor: f32,  // added to the squared slope that divides an equation
    robust: f32, // square of the residual up to which the weight is nearly constant
    border: f32, // 1 to weight pixels near the border less
    time: f32,   // time of the older frame, in displacements: -1 or 2
    weight: f32, // weight of its equations beside the pair's
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad_0: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term_0: array<f32>;
@group(0) @binding(3) var<storage, read> certainty_0: array<f32>;
@group(0) @binding(4) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(5) var<storage, read> rest_1: array<f32>; // all rows of the cross term, then all rows of the certainty
@group(0) @binding(6) var<storage, read> flow: array<f32>;
@group(0) @binding(7) var<storage, read> pair: array<f32>; // the pair's equations
@group(0) @binding(8) var<storage, read_write> equations: array<f32>; // channels: G_xx, G_xy, G_yy, q_x, q_y

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let i = y * stride + x;
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let there = weighted_second_at(vec2f(f32(x), f32(y)) + params.time * d, params.kappa);
    var m = model(Expansion(quad_0[i], cross_term_0[i]), there.second, vec2f());
    m.a = params.time * m.a;
    let certainty = certainty_0[i] * there.certainty;
    let known = there.second.inside && certainty > 1e-6;
    let own = robust_equations(id.xy, slope_residual(m), params.weight * certainty, known);
    let at = 5u * y * stride + x;
    let g = vec3f(pair[at], pair[at + stride], pair[at + 2u * stride]);
    let q = vec2f(pair[at + 3u * stride], pair[at + 4u * stride]);
    store_equations(id.xy, finite_equations(PixelEquations(g + own.g, q + own.q), true));
}

fn cross_term_of(i: u32) -> f32 {
    return rest_1[i];
}

fn certainty_of(i: u32) -> f32 {
    return rest_1[i + (params.width + 3u) / 4u * 4u * params.height];
}
