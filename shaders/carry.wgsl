// Draws a flow towards the previous pair's, and keeps the result for the next pair.

struct Params {
    width: u32,
    height: u32,
    sense: f32,  // -1 for a flow from the earlier frame to the later one, 1 for one that leads back
    weight: f32, // weight of the previous flow where it equals the new one
    inverse: f32, // inverse of the squared difference at which the weight is half of that
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>; // two channels
@group(0) @binding(2) var<storage, read> previous: array<f32>; // three channels: the flow, and 1 if there is one
@group(0) @binding(3) var<storage, read_write> drawn: array<f32>; // two channels
@group(0) @binding(4) var<storage, read_write> kept: array<f32>; // three channels, as previous

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let place = vec2f(f32(x), f32(y)) + params.sense * d;
    let last = vec2u(params.width, params.height) - 1u;
    // NaN is not inside either.
    let inside = all(place >= vec2f()) && all(place <= vec2f(last));
    let at = select(vec2f(), place, inside);
    let first = vec2u(at);
    let second = min(first + 1u, last);
    let f = at - floor(at);
    let above = mix(previous_at(first), previous_at(vec2u(second.x, first.y)), f.x);
    let below = mix(previous_at(vec2u(first.x, second.y)), previous_at(second), f.x);
    let change = mix(above, below, f.y) - d;
    let far = dot(change, change);
    let known = inside && previous[(3u * y + 2u) * stride + x] > 0.0 && far <= 1e30;
    let result = select(d, d + params.weight / (1.0 + far * params.inverse) * change, known);
    if id.x < stride && id.y < params.height {
        drawn[2u * id.y * stride + id.x] = result.x;
        drawn[(2u * id.y + 1u) * stride + id.x] = result.y;
        kept[3u * id.y * stride + id.x] = result.x;
        kept[(3u * id.y + 1u) * stride + id.x] = result.y;
        kept[(3u * id.y + 2u) * stride + id.x] = 1.0;
    }
}

fn previous_at(at: vec2u) -> vec2f {
    let stride = (params.width + 3u) / 4u * 4u;
    let u = 3u * at.y * stride + at.x;
    return vec2f(previous[u], previous[u + stride]);
}
