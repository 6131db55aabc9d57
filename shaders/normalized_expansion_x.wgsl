// Polynomial expansion by normalised convolution, horizontal half: the moments of the certainty c with the
// applicability g, and the least-squares solution f ≈ xᵀA x + bᵀx + c, of which A and b are kept. Farnebäck 2003,
// section 2, with the separable Gaussian applicability of his thesis.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
    min_share: f32,       // the share of a term that the terms before it must leave unexplained
    least_certainty: f32, // of the whole neighbourhood
    outside: f32,         // weight of columns outside the image: 1 repeats the border, 0 leaves them out
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> moments: array<vec4f>;          // channels: Σ yᵏ g c for k to 4, Σ yᵏ g c f to 2
@group(0) @binding(2) var<uniform> applicability: array<vec4f, 1024>;    // zeros up to a multiple of four, then as in expansion_y
@group(0) @binding(3) var<storage, read_write> quad: array<vec4f>;       // per pixel: b_x, b_y, A_xx, A_yy
@group(0) @binding(4) var<storage, read_write> cross_term: array<vec4f>; // a plane: 2 A_xy
@group(0) @binding(5) var<storage, read_write> expansion_certainty: array<vec4f>;

const SPAN = vec2u(4u, 1u);
const MAX_STEPS = 18u;

@compute @workgroup_size(16, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let reach = (params.radius + 3u) / 4u;
    let y = min(id.y, params.height - 1u);
    var m = Moments();
    for (var k = 0u; k < min((4u * reach + params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let four = i32(id.x) - i32(reach) + i32(k);
        let x = vec4f(f32(4 * (i32(k) - i32(reach)))) + vec4f(0.0, 1.0, 2.0, 3.0);
        let g = applicability[3u * k];
        let xg = applicability[3u * k + 1u];
        let xxg = applicability[3u * k + 2u];
        let x3g = xxg * x;
        let c0 = columns(y, 0u, four);
        m.m_00 += slide(c0.a, c0.b, g);
        m.m_10 += slide(c0.a, c0.b, xg);
        m.m_20 += slide(c0.a, c0.b, xxg);
        m.m_30 += slide(c0.a, c0.b, x3g);
        m.m_40 += slide(c0.a, c0.b, x3g * x);
        let c1 = columns(y, 1u, four);
        m.m_01 += slide(c1.a, c1.b, g);
        m.m_11 += slide(c1.a, c1.b, xg);
        m.m_21 += slide(c1.a, c1.b, xxg);
        m.m_31 += slide(c1.a, c1.b, x3g);
        let c2 = columns(y, 2u, four);
        m.m_02 += slide(c2.a, c2.b, g);
        m.m_12 += slide(c2.a, c2.b, xg);
        m.m_22 += slide(c2.a, c2.b, xxg);
        let c3 = columns(y, 3u, four);
        m.m_03 += slide(c3.a, c3.b, g);
        m.m_13 += slide(c3.a, c3.b, xg);
        let c4 = columns(y, 4u, four);
        m.m_04 += slide(c4.a, c4.b, g);
        let f0 = columns(y, 5u, four);
        m.f_00 += slide(f0.a, f0.b, g);
        m.f_10 += slide(f0.a, f0.b, xg);
        m.f_20 += slide(f0.a, f0.b, xxg);
        let f1 = columns(y, 6u, four);
        m.f_01 += slide(f1.a, f1.b, g);
        m.f_11 += slide(f1.a, f1.b, xg);
        let f2 = columns(y, 7u, four);
        m.f_02 += slide(f2.a, f2.b, g);
    }
    store(id.x, id.y, solve(m, params.min_share, params.least_certainty));
}

struct Columns {
    a: vec4f,
    b: vec4f,
}

// Four columns of a channel and the next four; beyond the ends of the row the end's value times its weight.
fn columns(y: u32, channel: u32, four: i32) -> Columns {
    let stride = (params.width + 3u) / 4u;
    let row = (8u * y + channel) * stride;
    let last = i32(stride) - 1;
    return Columns(
        weight(four) * repeat_ends(moments[row + u32(clamp(four, 0, last))], four, last),
        weight(four + 1) * repeat_ends(moments[row + u32(clamp(four + 1, 0, last))], four + 1, last),
    );
}

fn weight(four: i32) -> vec4f {
    let columns = vec4i(4 * four) + vec4i(0, 1, 2, 3);
    return select(vec4f(params.outside), vec4f(1.0), columns >= vec4i(0) & columns < vec4i(i32(params.width)));
}

fn store(four: u32, y: u32, s: Solution) {
    let stride = (params.width + 3u) / 4u;
    if four >= stride || y >= params.height {
        return;
    }
    let b_x = repeat_last(s.b_x, 4u * four, params.width);
    let b_y = repeat_last(s.b_y, 4u * four, params.width);
    let a_xx = repeat_last(s.a_xx, 4u * four, params.width);
    let a_yy = repeat_last(s.a_yy, 4u * four, params.width);
    let at = y * stride + four;
    quad[4u * at] = vec4f(b_x.x, b_y.x, a_xx.x, a_yy.x);
    quad[4u * at + 1u] = vec4f(b_x.y, b_y.y, a_xx.y, a_yy.y);
    quad[4u * at + 2u] = vec4f(b_x.z, b_y.z, a_xx.z, a_yy.z);
    quad[4u * at + 3u] = vec4f(b_x.w, b_y.w, a_xx.w, a_yy.w);
    cross_term[at] = repeat_last(s.cross_term, 4u * four, params.width);
    expansion_certainty[at] = repeat_last(s.certainty, 4u * four, params.width);
}
