// Columns of a picture smoothed by a Gaussian and read at fractional rows: the vertical half of one pyramid step.

struct Params {
    width: u32,
    height: u32,    // of the result
    in_height: u32,
    taps: u32,      // of the Gaussian, odd
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> gray: array<vec4f>;
@group(0) @binding(2) var<storage, read> gauss: array<f32>;
@group(0) @binding(3) var<storage, read> place: array<vec2f>; // whole and fractional row to read at
@group(0) @binding(4) var<storage, read_write> columns: array<vec4f>;

const SPAN = vec2u(4u, 1u);
const MAX_TAPS = 4096u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x * SPAN.x >= params.width || id.y >= params.height {
        return;
    }
    let stride = (params.width + 3u) / 4u;
    let at = place[id.y];
    let first = i32(at.x) - i32(params.taps / 2u);
    var sum = vec4f();
    var before = 0.0;
    // Reading between two smoothed rows is one sum over taps + 1 rows, with the two rows' weights mixed.
    for (var j = 0u; j < min(params.taps, MAX_TAPS); j++) {
        let weight = gauss[j];
        sum += mix(weight, before, at.y) * gray[reflect_101(first + i32(j), i32(params.in_height)) * stride + id.x];
        before = weight;
    }
    let past = reflect_101(first + i32(params.taps), i32(params.in_height));
    columns[id.y * stride + id.x] = sum + before * at.y * gray[past * stride + id.x];
}
