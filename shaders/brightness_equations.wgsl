// Each pixel's equations for the increment of its displacement from the constancy of brightness.
// Horn and Schunck 1981; robust weights after Charbonnier, Blanc-Féraud, Aubert and Barlaud 1997.

struct Params {
    width: u32,
    height: u32,
    robust: f32, // inverse square of the difference up to which the weight is nearly constant; 0 for constant weights
    prior: f32,  // added to G_xx and G_yy, which draws the increment towards 0
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> mean: array<f32>;
@group(0) @binding(2) var<storage, read> change: array<f32>;
@group(0) @binding(3) var<storage, read> share: array<f32>;
@group(0) @binding(4) var<storage, read_write> equations: array<f32>; // channels: G_xx, G_xy, G_yy, q_x, q_y

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let columns = y * stride + neighbours(x, params.width);
    let rows = stride * neighbours(y, params.height) + x;
    let own = y * stride + x;
    let i_x = slope(vec4f(mean[columns.x], mean[columns.y], mean[columns.z], mean[columns.w]), x, params.width);
    let i_y = slope(vec4f(mean[rows.x], mean[rows.y], mean[rows.z], mean[rows.w]), y, params.height);
    let i_t = change[own];
    let shares = min(
        vec4f(share[columns.x], share[columns.y], share[columns.z], share[columns.w]),
        vec4f(share[rows.x], share[rows.y], share[rows.z], share[rows.w]),
    );
    let known = min(min(min(shares.x, shares.y), min(shares.z, shares.w)), share[own]);
    let w = known * inverseSqrt(1.0 + i_t * i_t * params.robust);
    let g = w * vec2f(i_x, i_y);
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        equations[at] = g.x * i_x + params.prior;
        equations[at + stride] = g.x * i_y;
        equations[at + 2u * stride] = g.y * i_y + params.prior;
        equations[at + 3u * stride] = -g.x * i_t;
        equations[at + 4u * stride] = -g.y * i_t;
    }
}

// The neighbours i − 2, i − 1, i + 1 and i + 2 of a row of n, the ends repeated.
fn neighbours(i: u32, n: u32) -> vec4u {
    let last = n - 1u;
    return vec4u(max(i, 2u) - 2u, max(i, 1u) - 1u, min(i + 1u, last), min(i + 2u, last));
}

// The slope at position i of a row of n pixels from these neighbours.
fn slope(v: vec4f, i: u32, n: u32) -> f32 {
    let near = v.z - v.y;
    let inner = (8.0 * near - (v.w - v.x)) * (1.0 / 12.0);
    let edge = near * select(1.0, 0.5, i > 0u && i + 1u < n);
    return select(edge, inner, i > 1u && i + 2u < n);
}
