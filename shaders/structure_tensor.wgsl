// Each pixel's gradient times its transpose. The gradient is Sobel's of 3 × 3 pixels, mirrored at the border.

struct Params {
    width: u32,
    height: u32,
    scale: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> gray: array<f32>;
@group(0) @binding(2) var<storage, read_write> tensor: array<f32>; // channels: xx, xy, yy

// A column is taken from the top down, three rows kept in registers.
const SPAN = vec2u(1u, 8u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let y0 = id.y * SPAN.y;
    if id.x >= stride || y0 >= params.height {
        return;
    }
    let x = i32(min(id.x, params.width - 1u));
    let n = i32(params.width);
    let columns = vec3u(reflect_101(x - 1, n), u32(x), reflect_101(x + 1, n));
    var above = row(columns, i32(y0) - 1);
    var here = row(columns, i32(y0));
    for (var i = 0u; i < SPAN.y; i++) {
        let y = y0 + i;
        if y >= params.height {
            break;
        }
        let below = row(columns, i32(y) + 1);
        let differences = (above.z - above.x) + 2.0 * (here.z - here.x) + (below.z - below.x);
        let down = below - above;
        let g = params.scale * vec2f(differences, down.x + 2.0 * down.y + down.z);
        let at = 3u * y * stride + id.x;
        tensor[at] = g.x * g.x;
        tensor[at + stride] = g.x * g.y;
        tensor[at + 2u * stride] = g.y * g.y;
        above = here;
        here = below;
    }
}

fn row(columns: vec3u, y: i32) -> vec3f {
    let start = reflect_101(y, i32(params.height)) * ((params.width + 3u) / 4u * 4u);
    return vec3f(gray[start + columns.x], gray[start + columns.y], gray[start + columns.z]);
}
