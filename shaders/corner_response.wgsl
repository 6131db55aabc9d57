// The corner response of each pixel: of the structure tensor summed over a block, the smaller eigenvalue, or Harris'
// determinant less k times the squared trace.

struct Params {
    width: u32,
    height: u32,
    block: u32,
    harris: u32, // 0 for the smaller eigenvalue
    k: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<f32>; // three channels, summed along columns
@group(0) @binding(2) var<storage, read_write> response: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_BLOCK = 64u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let row = 3u * id.y * stride;
    let first = i32(min(id.x, params.width - 1u)) - i32(params.block / 2u);
    var sum = vec3f();
    for (var k = 0u; k < min(params.block, MAX_BLOCK); k++) {
        let at = row + reflect_101(first + i32(k), i32(params.width));
        sum += vec3f(columns[at], columns[at + stride], columns[at + 2u * stride]);
    }
    let trace = sum.x + sum.z;
    let a = 0.5 * sum.x;
    let c = 0.5 * sum.z;
    let smaller = (a + c) - sqrt((a - c) * (a - c) + sum.y * sum.y);
    let harris = sum.x * sum.z - sum.y * sum.y - params.k * trace * trace;
    response[id.y * stride + id.x] = select(smaller, harris, params.harris == 1u);
}
