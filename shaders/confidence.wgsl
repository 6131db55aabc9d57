// The confidence of each pixel's flow: rows of the evidence, already averaged along columns, are averaged, and their
// predicted standard error is mapped to 0 to 1.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<vec4f>; // channels: G_xx, G_xy, G_yy, ‖Δb‖², coverage
@group(0) @binding(2) var<uniform> window: array<vec4f, 1024>;  // as in solve
@group(0) @binding(3) var<storage, read_write> confidence: array<vec4f>;

const SPAN = vec2u(16u, 1u);

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let four = 4u * id.x;
    let y = min(id.y, params.height - 1u);
    let s = averages(four, y);
    store(four, id.y, s.four_0);
    store(four + 1u, id.y, s.four_1);
    store(four + 2u, id.y, s.four_2);
    store(four + 3u, id.y, s.four_3);
}

fn store(four: u32, y: u32, evidence: Five) {
    let stride = (params.width + 3u) / 4u;
    let value = confidence_of(evidence.a, evidence.b, evidence.c, evidence.d, evidence.e);
    if four < stride && y < params.height {
        confidence[y * stride + four] = repeat_last(value, 4u * four, params.width);
    }
}
