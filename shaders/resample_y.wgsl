// Smooths the columns of an image by a Gaussian and samples them at fractional rows: the vertical half of one pyramid
// step.

struct Params {
    width: u32,
    height: u32,    // of the result
    in_height: u32,
    taps: u32,      // of the Gaussian, odd
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> gray: array<vec4f>;
@group(0) @binding(2) var<uniform> gauss: array<vec4f, 1024>; // its samples, then zeros
@group(0) @binding(3) var<storage, read> place: array<vec2f>; // whole and fractional row to read at
@group(0) @binding(4) var<storage, read_write> columns: array<vec4f>;

const SPAN = vec2u(4u, 1u);
const MAX_STEPS = 1024u;

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
    // Sampling between two smoothed rows is one sum over taps + 1 rows, with the two rows' weights mixed.
    for (var k = 0u; k < min((params.taps + 4u) / 4u, MAX_STEPS); k++) {
        let w = gauss[k];
        let weights = mix(w, vec4f(before, w.xyz), at.y);
        sum += weights.x * row(first, 4u * k, id.x);
        sum += weights.y * row(first, 4u * k + 1u, id.x);
        sum += weights.z * row(first, 4u * k + 2u, id.x);
        sum += weights.w * row(first, 4u * k + 3u, id.x);
        before = w.w;
    }
    columns[id.y * stride + id.x] = sum;
}

// Row j of those under the Gaussian; past the last one, where the weights are zero, that one.
fn row(first: i32, j: u32, x4: u32) -> vec4f {
    let y = reflect_101(first + i32(min(j, params.taps)), i32(params.in_height));
    return gray[y * ((params.width + 3u) / 4u) + x4];
}
