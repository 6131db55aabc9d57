// The agreement of each pixel, less where the flow bends.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> agreement: array<f32>;
@group(0) @binding(2) var<storage, read> flow: array<f32>;
@group(0) @binding(3) var<storage, read_write> steady: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let left = max(x, 1u) - 1u;
    let right = min(x + 1u, params.width - 1u);
    let above = max(y, 1u) - 1u;
    let below = min(y + 1u, params.height - 1u);
    let twice = 2.0 * displacement(x, y);
    // A direction without two neighbours adds nothing.
    let sideways = select(0.0, 1.0, right - left == 2u) * (displacement(left, y) + displacement(right, y) - twice);
    let upright = select(0.0, 1.0, below - above == 2u) * (displacement(x, above) + displacement(x, below) - twice);
    let bend = sideways + upright;
    let found = agreement[y * stride + x] / sqrt(1.0 + 100.0 * dot(bend, bend));
    if id.x < stride && id.y < params.height {
        steady[id.y * stride + id.x] = found;
    }
}

fn displacement(x: u32, y: u32) -> vec2f {
    let stride = (params.width + 3u) / 4u * 4u;
    return vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
}
