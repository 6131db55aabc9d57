// Moves a flow field along itself by one frame: the prediction of the next pair's flow.
// Adarve and Mahony 2016; Courant, Isaacson and Rees 1952.

struct Params {
    width: u32,
    height: u32,
    sense: f32, // -1 for a flow from the earlier frame to the later one, 1 for one that leads back
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>; // two channels
@group(0) @binding(2) var<storage, read_write> moved: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let last = vec2f(f32(params.width - 1u), f32(params.height - 1u));
    let at = clamp(vec2f(f32(x), f32(y)) + params.sense * d, vec2f(), last);
    let nearest = floor(at + 0.5);
    let f = at - nearest;
    let columns = neighbours(u32(nearest.x), params.width);
    let rows = neighbours(u32(nearest.y), params.height);
    let w = weights(f.x);
    let w_y = weights(f.y);
    let result = w_y.x * line(rows.x, columns, w) + w_y.y * line(rows.y, columns, w) + w_y.z * line(rows.z, columns, w);
    if id.x < stride && id.y < params.height {
        moved[2u * id.y * stride + id.x] = result.x;
        moved[(2u * id.y + 1u) * stride + id.x] = result.y;
    }
}

fn neighbours(i: u32, n: u32) -> vec3u {
    return vec3u(max(i, 1u) - 1u, i, min(i + 1u, n - 1u));
}

// The quadratic B-spline's weights of the nearest pixel and of those beside it.
fn weights(f: f32) -> vec3f {
    return vec3f(0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f));
}

fn line(y: u32, columns: vec3u, w: vec3f) -> vec2f {
    let stride = (params.width + 3u) / 4u * 4u;
    let u = 2u * y * stride;
    let v = u + stride;
    return vec2f(
        dot(w, vec3f(flow[u + columns.x], flow[u + columns.y], flow[u + columns.z])),
        dot(w, vec3f(flow[v + columns.x], flow[v + columns.y], flow[v + columns.z])),
    );
}
