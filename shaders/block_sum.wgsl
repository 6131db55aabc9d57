// Sums the columns of three channels over a block's height, mirrored at the border.

struct Params {
    width: u32,
    height: u32,
    block: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> tensor: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> columns: array<vec4f>;

const SPAN = vec2u(4u, 1u);
// The three channels of a row lie side by side.
const SIDE_BY_SIDE = 3u;
const MAX_BLOCK = 64u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let row = 3u * ((params.width + 3u) / 4u);
    if id.x >= row || id.y >= params.height {
        return;
    }
    let first = i32(id.y) - i32(params.block / 2u);
    var sum = vec4f();
    for (var k = 0u; k < min(params.block, MAX_BLOCK); k++) {
        sum += tensor[reflect_101(first + i32(k), i32(params.height)) * row + id.x];
    }
    columns[id.y * row + id.x] = sum;
}
