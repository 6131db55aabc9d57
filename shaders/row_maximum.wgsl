// The largest value of each row where the mask is over 0, or the lowest number where it is nowhere.
//
// A workgroup takes one row. Its invocations take every 64th pixel each, and then halve the values among them.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> response: array<f32>;
@group(0) @binding(2) var<storage, read> mask: array<f32>;
@group(0) @binding(3) var<storage, read_write> maximum: array<f32>; // one pixel wide

const TILE = vec2u(4u, 1u);
const LANES = 64u;
const MAX_SIDE = 16384u;
const LOWEST = -3.4028235e38;

var<workgroup> largest: array<f32, 64>;

@compute @workgroup_size(64, 1)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let start = group.y * ((params.width + 3u) / 4u * 4u);
    var value = LOWEST;
    for (var x = local.x; x < min(params.width, MAX_SIDE); x += LANES) {
        value = max(value, select(LOWEST, response[start + x], mask[start + x] > 0.0));
    }
    largest[local.x] = value;
    workgroupBarrier();
    for (var k = 0u; k < 6u; k++) {
        let other = local.x + (32u >> k);
        if other < (64u >> k) {
            largest[local.x] = max(largest[local.x], largest[other]);
        }
        workgroupBarrier();
    }
    if local.x < 4u {
        // The surplus repeats the only pixel.
        maximum[4u * group.y + local.x] = largest[0];
    }
}
