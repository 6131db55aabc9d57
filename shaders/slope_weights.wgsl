// The slopes of the flow, each pixel's weighted by how near they are to the slopes expected there.

struct Params {
    width: u32,
    height: u32,
    spread: f32, // squared difference at which the weight is ½
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>;
@group(0) @binding(2) var<storage, read> slope: array<f32>; // channels: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y
@group(0) @binding(3) var<storage, read_write> weighted: array<f32>; // channels: weight, and weight times each slope

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let g = slopes(x, y);
    let off = g - expected(x, y);
    let w = params.spread / (params.spread + dot(off, off));
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        weighted[at] = w;
        weighted[at + stride] = w * g.x;
        weighted[at + 2u * stride] = w * g.y;
        weighted[at + 3u * stride] = w * g.z;
        weighted[at + 4u * stride] = w * g.w;
    }
}
