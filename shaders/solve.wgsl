// Rows of the five channels averaged by a symmetric window, and the displacement that solves the averaged equations.
// Farnebäck 2003, section 3; the determinant is kept off zero by 10⁻³.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
@group(0) @binding(2) var<storage, read> window: array<f32>; // weights from −radius to radius
@group(0) @binding(3) var<storage, read_write> flow: array<vec4f>;

// Eight columns at a time: the window slides in registers, one new column a step.
const SPAN = vec2u(8u, 1u);
const MAX_TAPS = 1025u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let x0 = id.x * SPAN.x;
    if x0 >= params.width || id.y >= params.height {
        return;
    }
    let g_xx = sums(x0, id.y, 0u);
    let g_xy = sums(x0, id.y, 1u);
    let g_yy = sums(x0, id.y, 2u);
    let h_x = sums(x0, id.y, 3u);
    let h_y = sums(x0, id.y, 4u);
    store(x0, id.y, g_xx.left, g_xy.left, g_yy.left, h_x.left, h_y.left);
    if x0 + 4u < params.width {
        store(x0 + 4u, id.y, g_xx.right, g_xy.right, g_yy.right, h_x.right, h_y.right);
    }
}

struct Eight {
    left: vec4f,
    right: vec4f,
}

fn sums(x0: u32, y: u32, channel: u32) -> Eight {
    let start = (5u * y + channel) * ((params.width + 3u) / 4u * 4u);
    let left = i32(x0) - i32(params.radius);
    var a = vec4f(0.0, sample(start, left), sample(start, left + 1), sample(start, left + 2));
    var b = vec4f(
        sample(start, left + 3), sample(start, left + 4), sample(start, left + 5), sample(start, left + 6),
    );
    var sum = Eight();
    for (var k = 0u; k < min(2u * params.radius + 1u, MAX_TAPS); k++) {
        a = vec4f(a.yzw, b.x);
        b = vec4f(b.yzw, sample(start, left + i32(k) + 7));
        let w = window[k];
        sum.left += w * a;
        sum.right += w * b;
    }
    return sum;
}

fn sample(start: u32, x: i32) -> f32 {
    return columns[start + clamp_index(x, params.width)];
}

fn store(x: u32, y: u32, g_xx: vec4f, g_xy: vec4f, g_yy: vec4f, h_x: vec4f, h_y: vec4f) {
    let stride = (params.width + 3u) / 4u;
    let scale = 1.0 / (g_xx * g_yy - g_xy * g_xy + 1e-3);
    flow[2u * y * stride + x / 4u] = repeat_last(known((g_yy * h_x - g_xy * h_y) * scale), x, params.width);
    flow[(2u * y + 1u) * stride + x / 4u] = repeat_last(known((g_xx * h_y - g_xy * h_x) * scale), x, params.width);
}

// What overflow left without a value counts as no motion, so that it cannot spread.
fn known(d: vec4f) -> vec4f {
    return select(vec4f(), d, abs(d) <= vec4f(1e9));
}
