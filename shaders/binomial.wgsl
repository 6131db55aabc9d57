// Smooths an image by [1 2 1]/4 in both directions, mirrored at the border.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> gray: array<f32>;
@group(0) @binding(2) var<storage, read_write> smooth_gray: array<vec4f>;

// Rows are taken from the top down, the sums of three rows kept in registers.
const SPAN = vec2u(4u, 8u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let x0 = id.x * SPAN.x;
    let y0 = id.y * SPAN.y;
    if x0 >= params.width || y0 >= params.height {
        return;
    }
    var above = row(x0, i32(y0) - 1);
    var here = row(x0, i32(y0));
    for (var i = 0u; i < SPAN.y; i++) {
        let y = y0 + i;
        if y >= params.height {
            break;
        }
        let below = row(x0, i32(y) + 1);
        let sum = (above + 2.0 * here + below) * 0.0625;
        smooth_gray[y * ((params.width + 3u) / 4u) + id.x] = repeat_last(sum, x0, params.width);
        above = here;
        here = below;
    }
}

// Four neighbouring results of [1 2 1] along row y.
fn row(x0: u32, y: i32) -> vec4f {
    let start = reflect_101(y, i32(params.height)) * ((params.width + 3u) / 4u) * 4u;
    let x = i32(x0);
    let n = i32(params.width);
    let a = gray[start + reflect_101(x - 1, n)];
    let b = gray[start + reflect_101(x, n)];
    let c = gray[start + reflect_101(x + 1, n)];
    let d = gray[start + reflect_101(x + 2, n)];
    let e = gray[start + reflect_101(x + 3, n)];
    let f = gray[start + reflect_101(x + 4, n)];
    return vec4f(a + 2.0 * b + c, b + 2.0 * c + d, c + 2.0 * d + e, d + 2.0 * e + f);
}
