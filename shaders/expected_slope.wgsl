// Averages rows of weighted slopes by a symmetric window and divides them by the averaged weight.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<vec4f>; // channels: weight, and weight times each slope
@group(0) @binding(2) var<uniform> window: array<vec4f, 1024>;  // as in solve
@group(0) @binding(3) var<storage, read_write> slope: array<vec4f>; // channels: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y

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

fn store(four: u32, y: u32, means: Five) {
    let stride = (params.width + 3u) / 4u;
    let inverse = 1.0 / (means.a + 1e-12);
    if four < stride && y < params.height {
        let at = 4u * y * stride + four;
        slope[at] = clamped(means.b * inverse, four);
        slope[at + stride] = clamped(means.c * inverse, four);
        slope[at + 2u * stride] = clamped(means.d * inverse, four);
        slope[at + 3u * stride] = clamped(means.e * inverse, four);
    }
}

fn clamped(slopes: vec4f, four: u32) -> vec4f {
    return repeat_last(clamp(slopes, vec4f(-0.5), vec4f(0.5)), 4u * four, params.width);
}
