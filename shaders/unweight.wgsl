// Divides an image that was smoothed together with its certainty by it: the smoothed image of the known pixels.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> weighted: array<f32>;
@group(0) @binding(2) var<storage, read> certainty: array<f32>;
@group(0) @binding(3) var<storage, read_write> gray: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let at = min(id.y, params.height - 1u) * stride + min(id.x, params.width - 1u);
    let share = certainty[at];
    let value = weighted[at] / max(share, 1e-3);
    if id.x < stride && id.y < params.height {
        gray[id.y * stride + id.x] = select(0.0, value, share >= 1e-3);
    }
}
