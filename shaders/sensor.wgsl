// The camera sensor: adds noise to gray levels and rounds them to whole numbers from 0 to 255.

struct Params {
    width: u32,
    height: u32,
    noise: f32, // of a step of the sum of four 16-bit numbers
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> gray: array<f32>;
@group(0) @binding(2) var<storage, read> seed: array<u32>; // two words
@group(0) @binding(3) var<storage, read_write> picture: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let one = scrambled_one(seed[0] ^ scrambled_one(seed[1] ^ scrambled_one(y * params.width + x)));
    let other = scrambled_one(one ^ 0x9e3779b9u);
    let steps = i32((one >> 16u) + (one & 0xffffu) + (other >> 16u) + (other & 0xffffu)) - 131070;
    let level = gray[y * stride + x] + params.noise * f32(steps);
    if id.x < stride && id.y < params.height {
        picture[id.y * stride + id.x] = clamp(floor(level + 0.5), 0.0, 255.0);
    }
}
