// The geometric mean of a plane and of what is around each of its pixels, given for blocks of 4 × 4 pixels within a ring.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> near: array<f32>;
@group(0) @binding(2) var<storage, read> blocks: array<f32>;
@group(0) @binding(3) var<storage, read_write> mean: array<f32>;

// Blocks of zeros before the first block and after the last.
const RING = 4u;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let in_stride = ((params.width + 3u) / 4u + 2u * RING + 3u) / 4u * 4u;
    let pixel = min(id.xy, vec2u(params.width, params.height) - 1u);
    // In eighths of a block: the centre of the first block within the ring is pixel 1.5.
    let eighths = 2u * pixel + 8u * RING - 3u;
    let f = vec2f(eighths % 8u) / 8.0;
    let at = eighths.y / 8u * in_stride + eighths.x / 8u;
    let left = mix(blocks[at], blocks[at + in_stride], f.y);
    let right = mix(blocks[at + 1u], blocks[at + in_stride + 1u], f.y);
    let found = sqrt(near[pixel.y * stride + pixel.x] * mix(left, right, f.x));
    if id.x < stride && id.y < params.height {
        mean[id.y * stride + id.x] = found;
    }
}
