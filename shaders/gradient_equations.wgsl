// Each pixel's equations for its displacement from the image gradients in x, y and time.
// Lucas and Kanade 1981: Σ ∇I ∇Iᵀ d = Σ ∇I (∇I · d₀ − I_t), where d₀ is the flow so far and I_t what it leaves.

struct Params {
    width: u32,
    height: u32,
    residual: u32, // 0 for the right-hand sides, 1 for the square of I_t and the visible share
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> first: array<f32>;
@group(0) @binding(2) var<storage, read> certainty: array<f32>;
@group(0) @binding(3) var<storage, read> warped: array<f32>;
@group(0) @binding(4) var<storage, read> shown: array<f32>;
@group(0) @binding(5) var<storage, read> flow: array<f32>; // two channels
@group(0) @binding(6) var<storage, read_write> equations: array<f32>; // channels: G_xx, G_xy, G_yy, h_x, h_y

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let columns = vec3u(max(x, 1u) - 1u, x, min(x + 1u, params.width - 1u));
    let above = three((max(y, 1u) - 1u) * stride, columns);
    let middle = three(y * stride, columns);
    let below = three(min(y + 1u, params.height - 1u) * stride, columns);
    // Sobel's kernels over 8 and the mean over 9 pixels are derivatives.
    let i_x = 0.125 * ((above.i.z - above.i.x) + 2.0 * (middle.i.z - middle.i.x) + (below.i.z - below.i.x));
    let i_y = 0.125 * ((below.i.x - above.i.x) + 2.0 * (below.i.y - above.i.y) + (below.i.z - above.i.z));
    let changes = above.change + middle.change + below.change;
    let i_t = (1.0 / 9.0) * (changes.x + changes.y + changes.z);
    let shares = min(min(above.share, middle.share), below.share);
    let share = min(min(shares.x, shares.y), shares.z);
    let g = vec2f(share * i_x, share * i_y);
    let t = share * i_t;
    let squares = vec3f(g.x * g.x, g.x * g.y, g.y * g.y);
    let so_far = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let right = dot(g, so_far) - t;
    let rest = select(vec2f(g.x * right, g.y * right), vec2f(t * t, share), params.residual == 1u);
    // Overflow and NaN become zeros, so that they do not spread.
    let known = dot(abs(squares), vec3f(1.0)) + dot(abs(rest), vec2f(1.0)) <= 1e30;
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        equations[at] = select(0.0, squares.x, known);
        equations[at + stride] = select(0.0, squares.y, known);
        equations[at + 2u * stride] = select(0.0, squares.z, known);
        equations[at + 3u * stride] = select(0.0, rest.x, known);
        equations[at + 4u * stride] = select(0.0, rest.y, known);
    }
}

// Three neighbours in a row.
struct Three {
    i: vec3f,
    change: vec3f,
    share: vec3f,
}

fn three(row: u32, columns: vec3u) -> Three {
    let at = vec3u(row) + columns;
    let i = vec3f(first[at.x], first[at.y], first[at.z]);
    let there = vec3f(warped[at.x], warped[at.y], warped[at.z]);
    let c = vec3f(certainty[at.x], certainty[at.y], certainty[at.z]);
    let s = vec3f(shown[at.x], shown[at.y], shown[at.z]);
    return Three(i, there - i, c * s);
}
