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
    let place = vec2f(f32(x), f32(y)) + d;
    let whole = floor(place);
    // NaN is not inside either.
    let inside = all(whole >= vec2f()) && all(whole < vec2f(f32(params.width), f32(params.height)) - 1.0);
    let at = vec2u(select(vec2f(), whole, inside));
    let j = at.y * stride + at.x;
    // One past the end only where an image is one pixel wide or high, and then no place is inside.
    let right = select(0u, 1u, inside);
    let below = select(0u, stride, inside);
    let f = place - whole;
    let a = weighted(j, (1.0 - f.x) * (1.0 - f.y), f);
    let b = weighted(j + right, f.x * (1.0 - f.y), f - vec2f(1.0, 0.0));
    let c = weighted(j + below, (1.0 - f.x) * f.y, f - vec2f(0.0, 1.0));
    let e = weighted(j + below + right, f.x * f.y, f - 1.0);
    let sum = a.certainty + b.certainty + c.certainty + e.certainty;
    let second = Expansion(
        (a.quad + b.quad + c.quad + e.quad) / sum,
        (a.cross_term + b.cross_term + c.cross_term + e.cross_term) / sum,
    );
    let m = model(Expansion(quad_0[i], cross_term_0[i]), Second(second, inside), vec2f());
    // A place outside counts with the pixel's certainty; otherwise halving all certainty would double its weight.
    let own = certainty_0[i];
    let certainty = own * select(own, sum, inside);
    let outside = select(params.outside, 1.0, inside);
    // Equations without certainty are left out.
    store_equations(id.xy, slope_residual(m), certainty * outside, certainty > 1e-6);
}

// One of the four pixels around a place, continued to the place and times its weight and its certainty, so that pixels
// without an expansion do not draw the mean towards zero.
struct Weighted {
    quad: vec4f,
    cross_term: f32,
    certainty: f32,
}

fn weighted(i: u32, weight: f32, away: vec2f) -> Weighted {
    let w = weight * certainty_1[i];
    let quad = quad_1[i];
    let cross_term = cross_term_1[i];
    let slope = vec2f(2.0 * quad.z * away.x + cross_term * away.y, cross_term * away.x + 2.0 * quad.w * away.y);
    return Weighted(w * (quad + vec4f(params.kappa * slope, 0.0, 0.0)), w * cross_term, w);
}
