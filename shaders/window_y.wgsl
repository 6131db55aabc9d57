// Columns of five channels averaged by a symmetric window: the vertical half of the neighbourhood's sum.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> equations: array<vec4f>;
@group(0) @binding(2) var<storage, read> window: array<f32>; // weights from −radius to radius
@group(0) @binding(3) var<storage, read_write> columns: array<vec4f>;

// Eight rows at a time: the window of rows slides in registers, one new row a step.
const SPAN = vec2u(4u, 8u);
const MAX_TAPS = 1025u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let y0 = id.y * SPAN.y;
    if id.x * SPAN.x >= params.width || y0 >= params.height {
        return;
    }
    let top = i32(y0) - i32(params.radius);
    for (var channel = 0u; channel < 5u; channel++) {
        var f0 = vec4f();
        var f1 = row(id.x, top, channel);
        var f2 = row(id.x, top + 1, channel);
        var f3 = row(id.x, top + 2, channel);
        var f4 = row(id.x, top + 3, channel);
        var f5 = row(id.x, top + 4, channel);
        var f6 = row(id.x, top + 5, channel);
        var f7 = row(id.x, top + 6, channel);
        var s0 = vec4f(); var s1 = vec4f(); var s2 = vec4f(); var s3 = vec4f();
        var s4 = vec4f(); var s5 = vec4f(); var s6 = vec4f(); var s7 = vec4f();
        for (var k = 0u; k < min(2u * params.radius + 1u, MAX_TAPS); k++) {
            f0 = f1; f1 = f2; f2 = f3; f3 = f4; f4 = f5; f5 = f6; f6 = f7;
            f7 = row(id.x, top + i32(k) + 7, channel);
            let w = window[k];
            s0 += w * f0; s1 += w * f1; s2 += w * f2; s3 += w * f3;
            s4 += w * f4; s5 += w * f5; s6 += w * f6; s7 += w * f7;
        }
        store(id.x, y0, channel, s0);
        store(id.x, y0 + 1u, channel, s1);
        store(id.x, y0 + 2u, channel, s2);
        store(id.x, y0 + 3u, channel, s3);
        store(id.x, y0 + 4u, channel, s4);
        store(id.x, y0 + 5u, channel, s5);
        store(id.x, y0 + 6u, channel, s6);
        store(id.x, y0 + 7u, channel, s7);
    }
}

fn row(x4: u32, y: i32, channel: u32) -> vec4f {
    let stride = (params.width + 3u) / 4u;
    return equations[(5u * clamp_index(y, params.height) + channel) * stride + x4];
}

fn store(x4: u32, y: u32, channel: u32, sum: vec4f) {
    if y >= params.height {
        return;
    }
    let stride = (params.width + 3u) / 4u;
    columns[(5u * y + channel) * stride + x4] = sum;
}
