// The local maxima of a corner response: its value where none of the eight neighbours is larger and the mask allows a
// corner, and 0 elsewhere, as at the image's border.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> response: array<f32>;
@group(0) @binding(2) var<storage, read> mask: array<f32>;
@group(0) @binding(3) var<storage, read_write> maxima: array<f32>;

// A column is taken from the top down, three rows kept in registers.
const SPAN = vec2u(1u, 8u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let y0 = id.y * SPAN.y;
    if id.x >= stride || y0 >= params.height {
        return;
    }
    let x = min(id.x, params.width - 1u);
    let columns = vec3u(max(x, 1u) - 1u, x, min(x + 1u, params.width - 1u));
    let within = x > 0u && x + 1u < params.width;
    var above = row(columns, max(y0, 1u) - 1u);
    var here = row(columns, y0);
    for (var i = 0u; i < SPAN.y; i++) {
        let y = y0 + i;
        if y >= params.height {
            break;
        }
        let below = row(columns, min(y + 1u, params.height - 1u));
        let largest = max(max(above, below), here);
        let value = here.y;
        let kept = within && y > 0u && y + 1u < params.height && mask[y * stride + x] > 0.0
            && value >= max(max(largest.x, largest.y), largest.z);
        maxima[y * stride + id.x] = select(0.0, value, kept);
        above = here;
        here = below;
    }
}

fn row(columns: vec3u, y: u32) -> vec3f {
    let start = y * ((params.width + 3u) / 4u * 4u);
    return vec3f(response[start + columns.x], response[start + columns.y], response[start + columns.z]);
}
