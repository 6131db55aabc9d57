// Rows of a picture smoothed by a Gaussian and read at fractional columns: the horizontal half of one pyramid step.

struct Params {
    width: u32,     // of the result
    height: u32,
    in_width: u32,
    taps: u32,      // of the Gaussian, odd
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
@group(0) @binding(2) var<storage, read> gauss: array<f32>;
@group(0) @binding(3) var<storage, read> place: array<vec2f>; // whole and fractional column to read at
@group(0) @binding(4) var<storage, read_write> level: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_TAPS = 4096u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let start = id.y * ((params.in_width + 3u) / 4u * 4u);
    let at = place[min(id.x, params.width - 1u)];
    let first = i32(at.x) - i32(params.taps / 2u);
    var sum = 0.0;
    var before = 0.0;
    for (var j = 0u; j < min(params.taps, MAX_TAPS); j++) {
        let weight = gauss[j];
        sum += mix(weight, before, at.y) * columns[start + reflect_101(first + i32(j), i32(params.in_width))];
        before = weight;
    }
    let past = reflect_101(first + i32(params.taps), i32(params.in_width));
    level[id.y * stride + id.x] = sum + before * at.y * columns[start + past];
}
