// Polynomial expansion, vertical half: an image's columns summed with the applicability g times 1, y and y².
// Farnebäck 2003, section 2, with the separable Gaussian applicability of his thesis.

struct Params {
    width: u32,
    height: u32,
    radius: u32, // of the neighbourhood: 2 radius + 1 rows
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> level: array<vec4f>;
@group(0) @binding(2) var<uniform> applicability: array<vec4f, 1024>; // four samples each of g, y g, y² g, then the next
@group(0) @binding(3) var<storage, read_write> moments: array<vec4f>; // channels: Σ g f, Σ y g f, Σ y² g f

// Four rows at a time: the window of rows slides in registers, four new rows per step.
const SPAN = vec2u(4u, 4u);
const MAX_STEPS = 17u;

@compute @workgroup_size(32, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let y0 = i32(id.y * SPAN.y);
    var y = y0 - i32(params.radius);
    var f0 = row(id.x, y);
    var f1 = row(id.x, y + 1);
    var f2 = row(id.x, y + 2);
    var f3 = row(id.x, y + 3);
    y += 4;
    var a = Four();
    var b = Four();
    var c = Four();
    for (var k = 0u; k < min((2u * params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let f4 = row(id.x, y);
        let f5 = row(id.x, y + 1);
        let f6 = row(id.x, y + 2);
        let f7 = row(id.x, y + 3);
        a = add(a, applicability[3u * k], f0, f1, f2, f3, f4, f5, f6);
        b = add(b, applicability[3u * k + 1u], f0, f1, f2, f3, f4, f5, f6);
        c = add(c, applicability[3u * k + 2u], f0, f1, f2, f3, f4, f5, f6);
        f0 = f4; f1 = f5; f2 = f6; f3 = f7;
        y += 4;
    }
    store(id.x, y0, a.a, b.a, c.a);
    store(id.x, y0 + 1, a.b, b.b, c.b);
    store(id.x, y0 + 2, a.c, b.c, c.c);
    store(id.x, y0 + 3, a.d, b.d, c.d);
}

struct Four {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// Four sums, one row apart, of four weighted rows each.
fn add(s: Four, w: vec4f, f0: vec4f, f1: vec4f, f2: vec4f, f3: vec4f, f4: vec4f, f5: vec4f, f6: vec4f) -> Four {
    return Four(
        s.a + (w.x * f0 + w.y * f1 + w.z * f2 + w.w * f3),
        s.b + (w.x * f1 + w.y * f2 + w.z * f3 + w.w * f4),
        s.c + (w.x * f2 + w.y * f3 + w.z * f4 + w.w * f5),
        s.d + (w.x * f3 + w.y * f4 + w.z * f5 + w.w * f6),
    );
}

fn row(x4: u32, y: i32) -> vec4f {
    let stride = (params.width + 3u) / 4u;
    return level[clamp_index(y, params.height) * stride + min(x4, stride - 1u)];
}

fn store(x4: u32, y: i32, a: vec4f, b: vec4f, c: vec4f) {
    let stride = (params.width + 3u) / 4u;
    if x4 < stride && y < i32(params.height) {
        let at = 3u * u32(y) * stride + x4;
        moments[at] = a;
        moments[at + stride] = b;
        moments[at + 2u * stride] = c;
    }
}
