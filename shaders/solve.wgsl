// Rows of the five channels averaged by a symmetric window, and the displacement that solves the averaged equations.
// Farnebäck 2003, section 3; the determinant is kept off zero by 10⁻³.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<vec4f>;
@group(0) @binding(2) var<storage, read> window: array<vec4f>; // zeros up to a whole four, weights, then zeros
@group(0) @binding(3) var<storage, read_write> flow: array<vec4f>;

const SPAN = vec2u(16u, 1u);

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let four = 4u * id.x;
    let y = min(id.y, params.height - 1u);
    let g_xx = sums(four, y, 0u);
    let g_xy = sums(four, y, 1u);
    let g_yy = sums(four, y, 2u);
    let h_x = sums(four, y, 3u);
    let h_y = sums(four, y, 4u);
    store(four, id.y, g_xx.a, g_xy.a, g_yy.a, h_x.a, h_y.a);
    store(four + 1u, id.y, g_xx.b, g_xy.b, g_yy.b, h_x.b, h_y.b);
    store(four + 2u, id.y, g_xx.c, g_xy.c, g_yy.c, h_x.c, h_y.c);
    store(four + 3u, id.y, g_xx.d, g_xy.d, g_yy.d, h_x.d, h_y.d);
}

fn store(four: u32, y: u32, g_xx: vec4f, g_xy: vec4f, g_yy: vec4f, h_x: vec4f, h_y: vec4f) {
    let stride = (params.width + 3u) / 4u;
    let scale = 1.0 / (g_xx * g_yy - g_xy * g_xy + 1e-3);
    let u = repeat_last(known((g_yy * h_x - g_xy * h_y) * scale), 4u * four, params.width);
    let v = repeat_last(known((g_xx * h_y - g_xy * h_x) * scale), 4u * four, params.width);
    if four < stride && y < params.height {
        flow[2u * y * stride + four] = u;
        flow[(2u * y + 1u) * stride + four] = v;
    }
}

// What overflow left without a value counts as no motion, so that it cannot spread.
fn known(d: vec4f) -> vec4f {
    return select(vec4f(), d, abs(d) <= vec4f(1e9));
}
