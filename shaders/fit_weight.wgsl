// The weight of each pixel's flow for its neighbours: high where the two frames agree under it.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> squared_misfit: array<f32>;
@group(0) @binding(2) var<storage, read_write> weight: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let before = max(x, 1u) - 1u;
    let next = min(x + 1u, params.width - 1u);
    let m = 0.25 * column(before, y) + 0.5 * column(x, y) + 0.25 * column(next, y);
    // exp(−m / (2 · 0.35²))
    let found = power_of_two(-5.8885516 * m) + 1e-3;
    if id.x < stride && id.y < params.height {
        weight[id.y * stride + id.x] = found;
    }
}

fn column(x: u32, y: u32) -> f32 {
    let stride = (params.width + 3u) / 4u * 4u;
    let above = max(y, 1u) - 1u;
    let below = min(y + 1u, params.height - 1u);
    return 0.25 * squared_misfit[above * stride + x] + 0.5 * squared_misfit[y * stride + x]
        + 0.25 * squared_misfit[below * stride + x];
}
