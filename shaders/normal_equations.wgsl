// Each pixel's normal equations for its displacement, with the second frame sampled where the flow so far points.
// Farnebäck 2003, section 3.

struct Params {
    width: u32,
    height: u32,
    carried: f32, // share of the flow so far in the equations: 1 or 0
    outside: f32, // weight of a place outside the second frame: 1 or 0
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad_0: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term_0: array<vec4f>;
@group(0) @binding(3) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(4) var<storage, read> cross_term_1: array<f32>;
@group(0) @binding(5) var<storage, read> flow: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> equations: array<vec4f>; // channels: G_xx, G_xy, G_yy, h_x, h_y

const SPAN = vec2u(4u, 1u);

override WORKGROUP_X = 32u;

@compute @workgroup_size(WORKGROUP_X, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let four = min(id.x, stride - 1u);
    let x0 = four * SPAN.x;
    let u = flow[2u * id.y * stride + four];
    let v = flow[(2u * id.y + 1u) * stride + four];
    let crosses = cross_term_0[id.y * stride + four];
    let last = params.width - 1u;
    let e0 = pixel(x0, id.y, crosses.x, vec2f(u.x, v.x));
    let e1 = pixel(min(x0 + 1u, last), id.y, crosses.y, vec2f(u.y, v.y));
    let e2 = pixel(min(x0 + 2u, last), id.y, crosses.z, vec2f(u.z, v.z));
    let e3 = pixel(min(x0 + 3u, last), id.y, crosses.w, vec2f(u.w, v.w));
    if id.x >= stride {
        return;
    }
    let at = 5u * id.y * stride + id.x;
    equations[at] = vec4f(e0.g.x, e1.g.x, e2.g.x, e3.g.x);
    equations[at + stride] = vec4f(e0.g.y, e1.g.y, e2.g.y, e3.g.y);
    equations[at + 2u * stride] = vec4f(e0.g.z, e1.g.z, e2.g.z, e3.g.z);
    equations[at + 3u * stride] = vec4f(e0.h.x, e1.h.x, e2.h.x, e3.h.x);
    equations[at + 4u * stride] = vec4f(e0.h.y, e1.h.y, e2.h.y, e3.h.y);
}

struct Equations {
    g: vec3f, // of AᵀA: xx, xy, yy
    h: vec2f, // of AᵀΔb
}

fn pixel(x: u32, y: u32, cross_term: f32, d: vec2f) -> Equations {
    let first = Expansion(quad_0[y * ((params.width + 3u) / 4u * 4u) + x], cross_term);
    let second = second_at(vec2f(f32(x), f32(y)) + d);
    let m = model(first, second, params.carried * d);
    let counts = select(params.outside, 1.0, second.inside);
    let weight = counts * border_weight(x, params.width) * border_weight(y, params.height);
    let a = weight * m.a;
    let b = weight * m.delta_b;
    let g = squared(a);
    let h = vec2f(a.x * b.x + a.y * b.y, a.y * b.x + a.z * b.y);
    // Overflow and NaN become zeros, so that they do not spread.
    let known = dot(abs(g), vec3f(1.0)) + dot(abs(h), vec2f(1.0)) <= 1e30;
    return Equations(select(vec3f(), g, known), select(vec2f(), h, known));
}
