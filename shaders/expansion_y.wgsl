// Polynomial expansion, vertical half: a picture's columns against the applicability g times 1, y and y².
// Farnebäck 2003, section 2, with the separable Gaussian applicability of his thesis.

struct Params {
    width: u32,
    height: u32,
    radius: u32, // of the neighbourhood: 2 radius + 1 rows
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> level: array<vec4f>;
@group(0) @binding(2) var<storage, read> applicability: array<vec4f>; // (g, y g, y² g, 0) for y = −radius … radius
@group(0) @binding(3) var<storage, read_write> moments: array<vec4f>; // channels: Σ g f, Σ y g f, Σ y² g f

// Four rows at a time: the window of rows slides in registers, one new row a step.
const SPAN = vec2u(4u, 4u);
const MAX_TAPS = 65u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let y0 = id.y * SPAN.y;
    if id.x * SPAN.x >= params.width || y0 >= params.height {
        return;
    }
    let top = i32(y0) - i32(params.radius);
    var f0 = vec4f();
    var f1 = row(id.x, top);
    var f2 = row(id.x, top + 1);
    var f3 = row(id.x, top + 2);
    var a0 = vec4f(); var a1 = vec4f(); var a2 = vec4f(); var a3 = vec4f();
    var b0 = vec4f(); var b1 = vec4f(); var b2 = vec4f(); var b3 = vec4f();
    var c0 = vec4f(); var c1 = vec4f(); var c2 = vec4f(); var c3 = vec4f();
    for (var k = 0u; k < min(2u * params.radius + 1u, MAX_TAPS); k++) {
        f0 = f1; f1 = f2; f2 = f3;
        f3 = row(id.x, top + i32(k) + 3);
        let g = applicability[k];
        a0 += g.x * f0; a1 += g.x * f1; a2 += g.x * f2; a3 += g.x * f3;
        b0 += g.y * f0; b1 += g.y * f1; b2 += g.y * f2; b3 += g.y * f3;
        c0 += g.z * f0; c1 += g.z * f1; c2 += g.z * f2; c3 += g.z * f3;
    }
    store(id.x, y0, a0, b0, c0);
    store(id.x, y0 + 1u, a1, b1, c1);
    store(id.x, y0 + 2u, a2, b2, c2);
    store(id.x, y0 + 3u, a3, b3, c3);
}

fn row(x4: u32, y: i32) -> vec4f {
    return level[clamp_index(y, params.height) * ((params.width + 3u) / 4u) + x4];
}

fn store(x4: u32, y: u32, a: vec4f, b: vec4f, c: vec4f) {
    if y >= params.height {
        return;
    }
    let stride = (params.width + 3u) / 4u;
    let at = 3u * y * stride + x4;
    moments[at] = a;
    moments[at + stride] = b;
    moments[at + 2u * stride] = c;
}
