// Polynomial expansion, horizontal half: the column moments summed with g times 1, x and x², and the least-squares
// solution f ≈ xᵀA x + bᵀx + c, of which A and b are kept.
// Farnebäck 2003, section 2, with the separable Gaussian applicability of his thesis.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
    inv_x: f32,    // of the inverse normal matrix: (x, x)
    inv_1_xx: f32, // (1, x²)
    inv_xx: f32,   // (x², x²)
    inv_xy: f32,   // (xy, xy)
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> moments: array<vec4f>;
@group(0) @binding(2) var<uniform> applicability: array<vec4f, 1024>;    // zeros up to a multiple of four, then as in expansion_y
@group(0) @binding(3) var<storage, read_write> quad: array<vec4f>;       // per pixel: b_x, b_y, A_xx, A_yy
@group(0) @binding(4) var<storage, read_write> cross_term: array<vec4f>; // a plane: 2 A_xy

// Eight columns at a time: the windows slide in registers, four new columns per step.
const SPAN = vec2u(8u, 1u);
const MAX_STEPS = 18u;

@compute @workgroup_size(16, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let four = 2u * id.x;
    let row = 3u * min(id.y, params.height - 1u) * stride;
    let reach = (params.radius + 3u) / 4u;
    var x = i32(four) - i32(reach);
    var f0 = column(row, x);
    var f1 = column(row, x + 1);
    var fy0 = column(row + stride, x);
    var fy1 = column(row + stride, x + 1);
    var fyy0 = column(row + 2u * stride, x);
    var fyy1 = column(row + 2u * stride, x + 1);
    x += 2;
    var left = Moments();
    var right = Moments();
    for (var k = 0u; k < min((4u * reach + params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let f2 = column(row, x);
        let fy2 = column(row + stride, x);
        let fyy2 = column(row + 2u * stride, x);
        let g = applicability[3u * k];
        let xg = applicability[3u * k + 1u];
        let xxg = applicability[3u * k + 2u];
        left = add(left, g, xg, xxg, f0, f1, fy0, fy1, fyy0, fyy1);
        right = add(right, g, xg, xxg, f1, f2, fy1, fy2, fyy1, fyy2);
        f0 = f1; f1 = f2; fy0 = fy1; fy1 = fy2; fyy0 = fyy1; fyy1 = fyy2;
        x++;
    }
    store(four, id.y, left);
    store(four + 1u, id.y, right);
}

// Values of four neighbouring pixels.
struct Moments {
    m_1: vec4f,
    m_x: vec4f,
    m_xx: vec4f,
    m_y: vec4f,
    m_xy: vec4f,
    m_yy: vec4f,
}

fn add(
    m: Moments, g: vec4f, xg: vec4f, xxg: vec4f,
    f0: vec4f, f1: vec4f, fy0: vec4f, fy1: vec4f, fyy0: vec4f, fyy1: vec4f,
) -> Moments {
    return Moments(
        m.m_1 + slide(f0, f1, g),
        m.m_x + slide(f0, f1, xg),
        m.m_xx + slide(f0, f1, xxg),
        m.m_y + slide(fy0, fy1, g),
        m.m_xy + slide(fy0, fy1, xg),
        m.m_yy + slide(fyy0, fyy1, g),
    );
}

// Four columns; beyond the ends of the row the end's value.
fn column(row: u32, four: i32) -> vec4f {
    let last = i32((params.width + 3u) / 4u) - 1;
    return repeat_ends(moments[row + u32(clamp(four, 0, last))], four, last);
}

fn store(four: u32, y: u32, m: Moments) {
    let stride = (params.width + 3u) / 4u;
    if four >= stride || y >= params.height {
        return;
    }
    let b_x = params.inv_x * m.m_x;
    let b_y = params.inv_x * m.m_y;
    let a_xx = params.inv_1_xx * m.m_1 + params.inv_xx * m.m_xx;
    let a_yy = params.inv_1_xx * m.m_1 + params.inv_xx * m.m_yy;
    let last = params.width - 1u - 4u * four;
    let at = (y * stride + four) * 4u;
    let q0 = vec4f(b_x.x, b_y.x, a_xx.x, a_yy.x);
    let q1 = select(q0, vec4f(b_x.y, b_y.y, a_xx.y, a_yy.y), last >= 1u);
    let q2 = select(q1, vec4f(b_x.z, b_y.z, a_xx.z, a_yy.z), last >= 2u);
    let q3 = select(q2, vec4f(b_x.w, b_y.w, a_xx.w, a_yy.w), last >= 3u);
    quad[at] = q0;
    quad[at + 1u] = q1;
    quad[at + 2u] = q2;
    quad[at + 3u] = q3;
    cross_term[y * stride + four] = repeat_last(params.inv_xy * m.m_xy, 4u * four, params.width);
}
