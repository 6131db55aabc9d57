// The displacement of each pixel by an affine motion model of its window: the horizontal half of the sums, and the solution
// of the six normal equations. Columns outside the image have no weight.
// Farnebäck 2003, section 4, parameterized displacement fields.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
    step: f32,    // the length of a pixel, relative to the radius
    regular: f32, // added to the diagonal of the normal matrix
    added: f32,   // the share of the flow so far to which the solution is added: 1 or 0
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<f32>; // thirteen channels, as in affine_columns
@group(0) @binding(2) var<uniform> window: array<vec4f, 1024>; // weights from −radius to radius, then zeros
@group(0) @binding(3) var<storage, read> so_far: array<f32>;
@group(0) @binding(4) var<storage, read_write> flow: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_TAPS = 1025u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let row = 13u * y * stride;
    // Sums of G (xx, xy, yy) and of q (x, y) times the monomials.
    var g_1 = vec3f();
    var g_x = vec3f();
    var g_y = vec3f();
    var g_xx = vec3f();
    var g_xy = vec3f();
    var g_yy = vec3f();
    var q_1 = vec2f();
    var q_x = vec2f();
    var q_y = vec2f();
    for (var k = 0u; k < min(2u * params.radius + 1u, MAX_TAPS); k++) {
        let column = i32(x) + i32(k) - i32(params.radius);
        let inside = column >= 0 && column < i32(params.width);
        let at = row + u32(clamp(column, 0, i32(params.width) - 1));
        let w_1 = select(0.0, window[k / 4u][k % 4u], inside);
        let t = (f32(k) - f32(params.radius)) * params.step;
        let w_x = w_1 * t;
        let w_xx = w_x * t;
        let one = vec3f(columns[at], columns[at + stride], columns[at + 2u * stride]);
        let q = vec2f(columns[at + 3u * stride], columns[at + 4u * stride]);
        let first = vec3f(columns[at + 5u * stride], columns[at + 6u * stride], columns[at + 7u * stride]);
        let q_first = vec2f(columns[at + 8u * stride], columns[at + 9u * stride]);
        let second = vec3f(columns[at + 10u * stride], columns[at + 11u * stride], columns[at + 12u * stride]);
        g_1 += w_1 * one;
        g_x += w_x * one;
        g_xx += w_xx * one;
        g_y += w_1 * first;
        g_xy += w_x * first;
        g_yy += w_1 * second;
        q_1 += w_1 * q;
        q_x += w_x * q;
        q_y += w_1 * q_first;
    }
    // Unknowns: u, v, ∂u/∂x, ∂v/∂x, ∂u/∂y, ∂v/∂y.
    let r = params.regular;
    let r_5 = Row(vec3f(g_y.yz, g_xy.y), vec3f(g_xy.z, g_yy.y, g_yy.z + r), q_y.y);
    var r_4 = Row(vec3f(g_y.xy, g_xy.x), vec3f(g_xy.y, g_yy.x + r, g_yy.y), q_y.x);
    var r_3 = Row(vec3f(g_x.yz, g_xx.y), vec3f(g_xx.z + r, g_xy.yz), q_x.y);
    var r_2 = Row(vec3f(g_x.xy, g_xx.x + r), vec3f(g_xx.y, g_xy.xy), q_x.x);
    var r_1 = Row(vec3f(g_1.y, g_1.z + r, g_x.y), vec3f(g_x.z, g_y.yz), q_1.y);
    var r_0 = Row(vec3f(g_1.x + r, g_1.y, g_x.x), vec3f(g_x.y, g_y.xy), q_1.x);
    r_4 = minus(r_4, r_5, r_4.b.z / r_5.b.z);
    r_3 = minus(r_3, r_5, r_3.b.z / r_5.b.z);
    r_2 = minus(r_2, r_5, r_2.b.z / r_5.b.z);
    r_1 = minus(r_1, r_5, r_1.b.z / r_5.b.z);
    r_0 = minus(r_0, r_5, r_0.b.z / r_5.b.z);
    r_3 = minus(r_3, r_4, r_3.b.y / r_4.b.y);
    r_2 = minus(r_2, r_4, r_2.b.y / r_4.b.y);
    r_1 = minus(r_1, r_4, r_1.b.y / r_4.b.y);
    r_0 = minus(r_0, r_4, r_0.b.y / r_4.b.y);
    r_2 = minus(r_2, r_3, r_2.b.x / r_3.b.x);
    r_1 = minus(r_1, r_3, r_1.b.x / r_3.b.x);
    r_0 = minus(r_0, r_3, r_0.b.x / r_3.b.x);
    r_1 = minus(r_1, r_2, r_1.a.z / r_2.a.z);
    r_0 = minus(r_0, r_2, r_0.a.z / r_2.a.z);
    r_0 = minus(r_0, r_1, r_0.a.y / r_1.a.y);
    let u = r_0.q / r_0.a.x;
    let v = (r_1.q - r_1.a.x * u) / r_1.a.y;
    if id.x < stride && id.y < params.height {
        let at = 2u * y * stride;
        flow[at + id.x] = params.added * so_far[at + x] + known(u);
        flow[at + stride + id.x] = params.added * so_far[at + stride + x] + known(v);
    }
}

// A row of the normal equations.
struct Row {
    a: vec3f,
    b: vec3f,
    q: f32,
}

fn minus(r: Row, pivot: Row, factor: f32) -> Row {
    return Row(r.a - factor * pivot.a, r.b - factor * pivot.b, r.q - factor * pivot.q);
}

// A result without a value, after overflow, becomes no motion, so that it cannot spread.
fn known(d: f32) -> f32 {
    return select(0.0, d, abs(d) <= 1e9);
}
