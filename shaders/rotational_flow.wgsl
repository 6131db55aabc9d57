// The flow that the camera's rotation alone causes, as an initial flow for the search.

struct Params {
    width: u32,
    height: u32,
    focal: vec2f,
    centre: vec2f,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> motion: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> flow: array<f32>; // from the current frame back to the previous one, pixels

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let pixel = vec2f(vec2u(min(id.x, params.width - 1u), id.y));
    let current = vec3f((pixel - params.centre) / params.focal, 1.0);
    let previous = turned(current);
    let shown = previous.z > 0.01;
    let z = select(1.0, previous.z, shown);
    // (x_prev / z − x_cur), without the difference of two large numbers.
    let moved = previous - current;
    let d = select(vec2f(), params.focal * (moved.xy - current.xy * moved.z) / z, shown);
    if id.x < stride && id.y < params.height {
        let at = 2u * id.y * stride + id.x;
        flow[at] = d.x;
        flow[at + stride] = d.y;
    }
}
