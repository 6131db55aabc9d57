// Smooths the rows of an image by a Gaussian and samples them at fractional columns: the horizontal half of one pyramid
// step.

struct Params {
    width: u32,     // of the result
    height: u32,
    in_width: u32,
    taps: u32,      // of the Gaussian, odd
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
@group(0) @binding(2) var<uniform> gauss: array<vec4f, 1024>; // its samples, then zeros
@group(0) @binding(3) var<storage, read> place: array<vec2f>; // whole and fractional column to read at
@group(0) @binding(4) var<storage, read_write> level: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_STEPS = 1024u;

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
    // Sampling between two smoothed columns is one sum over taps + 1 columns, with the two columns' weights mixed.
    for (var k = 0u; k < min((params.taps + 4u) / 4u, MAX_STEPS); k++) {
        let w = gauss[k];
        let weights = mix(w, vec4f(before, w.xyz), at.y);
        sum += weights.x * column(start, first, 4u * k);
        sum += weights.y * column(start, first, 4u * k + 1u);
        sum += weights.z * column(start, first, 4u * k + 2u);
        sum += weights.w * column(start, first, 4u * k + 3u);
        before = w.w;
    }
    level[id.y * stride + id.x] = sum;
}

// Column j of those under the Gaussian; past the last one, where the weights are zero, that one.
fn column(start: u32, first: i32, j: u32) -> f32 {
    return columns[start + reflect_101(first + i32(min(j, params.taps)), i32(params.in_width))];
}
