// Samples the second image where the flow so far points, and the visibility of each place.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> second: array<f32>;
@group(0) @binding(2) var<storage, read> certainty: array<f32>;
@group(0) @binding(3) var<storage, read> flow: array<f32>; // two channels
@group(0) @binding(4) var<storage, read_write> warped: array<f32>;
@group(0) @binding(5) var<storage, read_write> shown: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let place = vec2f(f32(x), f32(y)) + vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let last = vec2f(f32(params.width - 1u), f32(params.height - 1u));
    // NaN is not inside either.
    let inside = all(place >= vec2f()) && all(place <= last);
    let at = select(vec2f(), place, inside);
    let whole = floor(at);
    let f = at - whole;
    let left = u32(whole.x);
    let right = min(left + 1u, params.width - 1u);
    let above = u32(whole.y) * stride;
    let below = min(u32(whole.y) + 1u, params.height - 1u) * stride;
    let w_a = (1.0 - f.x) * (1.0 - f.y);
    let w_b = f.x * (1.0 - f.y);
    let w_c = (1.0 - f.x) * f.y;
    let w_d = f.x * f.y;
    let value = w_a * second[above + left] + w_b * second[above + right]
        + w_c * second[below + left] + w_d * second[below + right];
    let share = w_a * certainty[above + left] + w_b * certainty[above + right]
        + w_c * certainty[below + left] + w_d * certainty[below + right];
    if id.x < stride && id.y < params.height {
        warped[id.y * stride + id.x] = select(0.0, value, inside);
        shown[id.y * stride + id.x] = select(0.0, share, inside);
    }
}
