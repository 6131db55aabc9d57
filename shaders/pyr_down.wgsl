// Halves an image: smooths it by [1 4 6 4 1]/16 in both directions, mirrored at the border, and keeps every other pixel.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
    whole: u32, // 1 to round to whole gray levels
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> image: array<f32>;
@group(0) @binding(2) var<storage, read_write> half: array<f32>;

// A column of the result is taken from the top down, five rows of sums kept in registers.
const SPAN = vec2u(1u, 8u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let y0 = id.y * SPAN.y;
    if id.x >= stride || y0 >= params.height {
        return;
    }
    let x = i32(2u * min(id.x, params.width - 1u));
    let n = i32(params.in_width);
    let columns = array(reflect_101(x - 2, n), reflect_101(x - 1, n), u32(x), reflect_101(x + 1, n), reflect_101(x + 2, n));
    let first = 2 * i32(y0);
    var a = row(columns, first - 2);
    var b = row(columns, first - 1);
    var c = row(columns, first);
    for (var i = 0u; i < SPAN.y; i++) {
        let y = y0 + i;
        if y >= params.height {
            break;
        }
        let d = row(columns, 2 * i32(y) + 1);
        let e = row(columns, 2 * i32(y) + 2);
        let value = (a + 4.0 * b + 6.0 * c + 4.0 * d + e) * 0.00390625;
        half[y * stride + id.x] = select(value, floor(value + 0.5), params.whole == 1u);
        a = c;
        b = d;
        c = e;
    }
}

// The sum of five pixels in row y.
fn row(columns: array<u32, 5>, y: i32) -> f32 {
    let start = reflect_101(y, i32(params.in_height)) * ((params.in_width + 3u) / 4u * 4u);
    return image[start + columns[0]] + 4.0 * image[start + columns[1]] + 6.0 * image[start + columns[2]]
        + 4.0 * image[start + columns[3]] + image[start + columns[4]];
}
