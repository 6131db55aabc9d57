// Polynomial expansion, horizontal half: the column moments against g times 1, x and x², and the least-squares
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
@group(0) @binding(1) var<storage, read> moments: array<f32>;
@group(0) @binding(2) var<storage, read> applicability: array<vec4f>;    // (g, x g, x² g, 0) for x = −radius … radius
@group(0) @binding(3) var<storage, read_write> quad: array<vec4f>;       // a pixel each: b_x, b_y, A_xx, A_yy
@group(0) @binding(4) var<storage, read_write> cross_term: array<vec4f>; // a plane: 2 A_xy

// Four columns at a time: the windows slide in registers, one new column a step.
const SPAN = vec2u(4u, 1u);
const MAX_TAPS = 65u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let x0 = id.x * SPAN.x;
    if x0 >= params.width || id.y >= params.height {
        return;
    }
    let stride = (params.width + 3u) / 4u;
    let start = 3u * id.y * stride * 4u;
    let left = i32(x0) - i32(params.radius);
    // Components of the vectors are the four columns.
    var f = vec4f(0.0, sample(start, left, 0u), sample(start, left + 1, 0u), sample(start, left + 2, 0u));
    var fy = vec4f(0.0, sample(start, left, 1u), sample(start, left + 1, 1u), sample(start, left + 2, 1u));
    var fyy = vec4f(0.0, sample(start, left, 2u), sample(start, left + 1, 2u), sample(start, left + 2, 2u));
    var m_1 = vec4f();
    var m_x = vec4f();
    var m_xx = vec4f();
    var m_y = vec4f();
    var m_xy = vec4f();
    var m_yy = vec4f();
    for (var k = 0u; k < min(2u * params.radius + 1u, MAX_TAPS); k++) {
        let x = left + i32(k) + 3;
        f = vec4f(f.yzw, sample(start, x, 0u));
        fy = vec4f(fy.yzw, sample(start, x, 1u));
        fyy = vec4f(fyy.yzw, sample(start, x, 2u));
        let g = applicability[k];
        m_1 += g.x * f;
        m_x += g.y * f;
        m_xx += g.z * f;
        m_y += g.x * fy;
        m_xy += g.y * fy;
        m_yy += g.x * fyy;
    }
    let b_x = params.inv_x * m_x;
    let b_y = params.inv_x * m_y;
    let a_xx = params.inv_1_xx * m_1 + params.inv_xx * m_xx;
    let a_yy = params.inv_1_xx * m_1 + params.inv_xx * m_yy;
    let last = params.width - 1u - x0;
    let at = (id.y * stride + id.x) * 4u;
    let q0 = vec4f(b_x.x, b_y.x, a_xx.x, a_yy.x);
    let q1 = select(q0, vec4f(b_x.y, b_y.y, a_xx.y, a_yy.y), last >= 1u);
    let q2 = select(q1, vec4f(b_x.z, b_y.z, a_xx.z, a_yy.z), last >= 2u);
    let q3 = select(q2, vec4f(b_x.w, b_y.w, a_xx.w, a_yy.w), last >= 3u);
    quad[at] = q0;
    quad[at + 1u] = q1;
    quad[at + 2u] = q2;
    quad[at + 3u] = q3;
    cross_term[id.y * stride + id.x] = repeat_last(params.inv_xy * m_xy, x0, params.width);
}

fn sample(start: u32, x: i32, channel: u32) -> f32 {
    let stride = (params.width + 3u) / 4u * 4u;
    return moments[start + channel * stride + clamp_index(x, params.width)];
}
