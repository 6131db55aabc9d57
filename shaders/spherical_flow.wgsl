// Flow on the view sphere: the derotated motion of each pixel's bearing since the previous frame.

struct Params {
    width: u32,
    height: u32,
    focal: vec2f,
    centre: vec2f,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>;    // from the current frame back to the previous one, pixels
@group(0) @binding(2) var<storage, read> motion: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> spherical_flow: array<f32>; // 3 channels, radians per frame

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let base = 2u * y * stride + x;
    let d = vec2f(flow[base], flow[base + stride]);
    let known = dot(d, d) <= 1e12;
    let current = vec3f((vec2f(f32(x), f32(y)) - params.centre) / params.focal, 1.0);
    let shift = vec3f(select(vec2f(), d, known) / params.focal, 0.0);
    let unturned = current + shift;
    let previous = turned_back(unturned);
    let moved = midpoint_flow(current, previous, -shift - (previous - unturned)).flow;
    if id.x < stride && id.y < params.height {
        let at = 3u * id.y * stride + id.x;
        spherical_flow[at] = moved.x;
        spherical_flow[at + stride] = moved.y;
        spherical_flow[at + 2u * stride] = moved.z;
    }
}
