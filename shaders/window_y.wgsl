// Columns of five channels averaged by a symmetric window: the vertical half of the neighbourhood's sum.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> equations: array<vec4f>;
@group(0) @binding(2) var<storage, read> window: array<vec4f>; // weights from −radius to radius, then zeros
@group(0) @binding(3) var<storage, read_write> columns: array<vec4f>;

// Eight rows at a time: the window of rows slides in registers, four new rows a step. One channel an invocation.
const SPAN = vec2u(4u, 8u);
const SLICES = 5u;
const MAX_STEPS = 257u;

@compute @workgroup_size(32, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let y0 = i32(id.y * SPAN.y);
    var y = y0 - i32(params.radius);
    var f0 = row(id, y);
    var f1 = row(id, y + 1);
    var f2 = row(id, y + 2);
    var f3 = row(id, y + 3);
    var f4 = row(id, y + 4);
    var f5 = row(id, y + 5);
    var f6 = row(id, y + 6);
    var f7 = row(id, y + 7);
    y += 8;
    var s0 = vec4f(); var s1 = vec4f(); var s2 = vec4f(); var s3 = vec4f();
    var s4 = vec4f(); var s5 = vec4f(); var s6 = vec4f(); var s7 = vec4f();
    for (var k = 0u; k < min((2u * params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let f8 = row(id, y);
        let f9 = row(id, y + 1);
        let f10 = row(id, y + 2);
        let f11 = row(id, y + 3);
        let w = window[k];
        s0 += w.x * f0 + w.y * f1 + w.z * f2 + w.w * f3;
        s1 += w.x * f1 + w.y * f2 + w.z * f3 + w.w * f4;
        s2 += w.x * f2 + w.y * f3 + w.z * f4 + w.w * f5;
        s3 += w.x * f3 + w.y * f4 + w.z * f5 + w.w * f6;
        s4 += w.x * f4 + w.y * f5 + w.z * f6 + w.w * f7;
        s5 += w.x * f5 + w.y * f6 + w.z * f7 + w.w * f8;
        s6 += w.x * f6 + w.y * f7 + w.z * f8 + w.w * f9;
        s7 += w.x * f7 + w.y * f8 + w.z * f9 + w.w * f10;
        f0 = f4; f1 = f5; f2 = f6; f3 = f7; f4 = f8; f5 = f9; f6 = f10; f7 = f11;
        y += 4;
    }
    store(id, y0, s0);
    store(id, y0 + 1, s1);
    store(id, y0 + 2, s2);
    store(id, y0 + 3, s3);
    store(id, y0 + 4, s4);
    store(id, y0 + 5, s5);
    store(id, y0 + 6, s6);
    store(id, y0 + 7, s7);
}

fn row(id: vec3u, y: i32) -> vec4f {
    let stride = (params.width + 3u) / 4u;
    return equations[(SLICES * clamp_index(y, params.height) + id.z) * stride + min(id.x, stride - 1u)];
}

fn store(id: vec3u, y: i32, sum: vec4f) {
    let stride = (params.width + 3u) / 4u;
    if id.x < stride && y < i32(params.height) {
        columns[(SLICES * u32(y) + id.z) * stride + id.x] = sum;
    }
}
