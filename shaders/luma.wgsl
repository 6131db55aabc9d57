// Brightness of a frame's pixels, as f32.

struct Params {
    width: u32,
    height: u32,
    row_words: u32, // u32 words from one row to the next
    format: u32,    // 0 gray8, 1 gray16, 2 rgb8, 3 rgba8
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> frame: array<u32>;
@group(0) @binding(2) var<storage, read_write> gray: array<vec4f>;

// White is 255 in every format: the equations' constants are in those gray levels.
const WIDE = 1.0 / 257.0;

const SPAN = vec2u(4u, 1u);
const PIXELS = 4u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let x0 = id.x * SPAN.x;
    let stride = (params.width + 3u) / 4u;
    let last = params.width - 1u;
    let gray8 = params.format == 0u;
    let word = frame[id.y * params.row_words + min(id.x, stride - 1u)];
    var four = repeat_last(vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(0xffu)), x0, params.width);
    // A loop and no branch: where shaders run on the CPU, both sides of a branch are executed.
    for (var i = 0u; i < min(select(PIXELS, 0u, gray8), PIXELS); i++) {
        four = select(four, vec4f(pixel(min(x0 + i, last), id.y)), vec4u(0u, 1u, 2u, 3u) == vec4u(i));
    }
    if id.x < stride && id.y < params.height {
        gray[id.y * stride + id.x] = four;
    }
}

fn byte(offset: u32) -> u32 {
    return (frame[offset / 4u] >> (8u * (offset % 4u))) & 0xffu;
}

fn pixel(x: u32, y: u32) -> f32 {
    let row = 4u * params.row_words * y;
    switch params.format {
        case 1u: { return f32(byte(row + 2u * x) + 256u * byte(row + 2u * x + 1u)) * WIDE; }
        case 2u: { return luma(row + 3u * x); }
        default: { return luma(row + 4u * x); }
    }
}

fn luma(offset: u32) -> f32 {
    return f32((9798u * byte(offset) + 19235u * byte(offset + 1u) + 3735u * byte(offset + 2u) + 16384u) >> 15u);
}
