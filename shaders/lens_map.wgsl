// Where in the raw frame each pixel of an ideal, turned camera is to be read, and how far that can be trusted.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
    focal: vec2f,
    centre: vec2f,
    in_focal: vec2f,
    in_centre: vec2f,
    lens_a: vec4f,
    lens_b: vec4f,
    limit: f32,  // the lens is one to one up to this distance from the axis, squared
    margin: f32, // pixels
    padding: vec2f,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> motion: array<vec4f>;
@group(0) @binding(2) var<storage, read> mask: array<f32>; // of the raw frame
@group(0) @binding(3) var<storage, read_write> map: array<f32>; // channels: x and y in the raw frame
@group(0) @binding(4) var<storage, read_write> certainty: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let pixel = vec2f(vec2u(min(id.x, params.width - 1u), id.y));
    let ray = turned(vec3f((pixel - params.centre) / params.focal, 1.0));
    let ideal = ray.xy / max(ray.z, 1e-3);
    let lies = ray.z > 1e-3 && dot(ideal, ideal) < params.limit;
    let place = params.in_focal * distort(select(vec2f(), ideal, lies)) + params.in_centre;
    let last = vec2f(f32(params.in_width), f32(params.in_height)) - 1.0;
    // A pixel reaches half a pixel beyond its centre.
    let within = min(min(place.x, last.x - place.x), min(place.y, last.y - place.y)) + 0.5;
    let share = clamp(within / max(params.margin, 0.5), 0.0, 1.0);
    let held = clamp(place, vec2f(), last);
    let trusted = clamp(share * masked(held), 0.0, 1.0);
    if id.x < stride && id.y < params.height {
        let at = 2u * id.y * stride + id.x;
        map[at] = held.x;
        map[at + stride] = held.y;
        certainty[id.y * stride + id.x] = select(0.0, trusted, lies);
    }
}

// The mask between its pixels.
fn masked(place: vec2f) -> f32 {
    let stride = (params.in_width + 3u) / 4u * 4u;
    let whole = vec2u(place);
    let f = place - vec2f(whole);
    let right = min(whole.x + 1u, params.in_width - 1u);
    let above = whole.y * stride;
    let below = min(whole.y + 1u, params.in_height - 1u) * stride;
    return mix(mix(mask[above + whole.x], mask[above + right], f.x), mix(mask[below + whole.x], mask[below + right], f.x), f.y);
}
