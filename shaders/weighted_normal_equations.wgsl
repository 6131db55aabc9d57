// Each pixel's normal equations for its displacement, as in normal_equations.wgsl, weighted by the certainty of both
// frames' expansions: that of the first frame's pixel times that of the place in the second frame.
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
@group(0) @binding(3) var<storage, read> certainty_0: array<vec4f>;
@group(0) @binding(4) var<storage, read> quad_1: array<vec4f>;
@group(0) @binding(5) var<storage, read> cross_term_1: array<f32>;
@group(0) @binding(6) var<storage, read> certainty_1: array<f32>;
@group(0) @binding(7) var<storage, read> flow: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> equations: array<vec4f>; // channels: G_xx, G_xy, G_yy, h_x, h_y

const SPAN = vec2u(4u, 1u);

@compute @workgroup_size(32, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let four = min(id.x, stride - 1u);
    let x0 = four * SPAN.x;
    let u = flow[2u * id.y * stride + four];
    let v = flow[(2u * id.y + 1u) * stride + four];
    let crosses = cross_term_0[id.y * stride + four];
    let certainties = certainty_0[id.y * stride + four];
    let last = params.width - 1u;
    let e0 = pixel(x0, id.y, crosses.x, certainties.x, vec2f(u.x, v.x));
    let e1 = pixel(min(x0 + 1u, last), id.y, crosses.y, certainties.y, vec2f(u.y, v.y));
    let e2 = pixel(min(x0 + 2u, last), id.y, crosses.z, certainties.z, vec2f(u.z, v.z));
    let e3 = pixel(min(x0 + 3u, last), id.y, crosses.w, certainties.w, vec2f(u.w, v.w));
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

fn pixel(x: u32, y: u32, cross_term: f32, certainty: f32, d: vec2f) -> Equations {
    let stride = (params.width + 3u) / 4u * 4u;
    let place = vec2f(f32(x), f32(y)) + d;
    let whole = floor(place);
    // NaN is not inside either.
    let inside = all(whole >= vec2f()) && all(whole < vec2f(f32(params.width), f32(params.height)) - 1.0);
    let at = vec2u(select(vec2f(), whole, inside));
    let i = at.y * stride + at.x;
    // One past the end only where an image is one pixel wide or high, and then no place is inside.
    let right = select(0u, 1u, inside);
    let below = select(0u, stride, inside);
    let f = place - whole;
    let a = weighted(i, (1.0 - f.x) * (1.0 - f.y));
    let b = weighted(i + right, f.x * (1.0 - f.y));
    let c = weighted(i + below, (1.0 - f.x) * f.y);
    let e = weighted(i + below + right, f.x * f.y);
    let sum = a.certainty + b.certainty + c.certainty + e.certainty;
    let second = Expansion(
        (a.quad + b.quad + c.quad + e.quad) / sum,
        (a.cross_term + b.cross_term + c.cross_term + e.cross_term) / sum,
    );
    let m = model(Expansion(quad_0[y * stride + x], cross_term), Second(second, inside), params.carried * d);
    let counts = select(params.outside, 1.0, inside);
    let border = counts * border_weight(x, params.width) * border_weight(y, params.height);
    // A place outside counts with the pixel's certainty; otherwise halving all certainty would double its weight.
    let weight = certainty * select(certainty, sum, inside);
    let w = border * m.a;
    let z = border * m.delta_b;
    let g = weight * squared(w);
    let h = weight * vec2f(w.x * z.x + w.y * z.y, w.y * z.x + w.z * z.y);
    // Equations without certainty, overflow and NaN become zeros, so that they do not spread.
    let known = weight > 1e-6 && dot(abs(g), vec3f(1.0)) + dot(abs(h), vec2f(1.0)) <= 1e30;
    return Equations(select(vec3f(), g, known), select(vec2f(), h, known));
}

// One of the four pixels around a place, times its weight and its certainty, so that pixels without an expansion do
// not draw the mean towards zero.
struct Weighted {
    quad: vec4f,
    cross_term: f32,
    certainty: f32,
}

fn weighted(i: u32, weight: f32) -> Weighted {
    let w = weight * certainty_1[i];
    return Weighted(w * quad_1[i], w * cross_term_1[i], w);
}
