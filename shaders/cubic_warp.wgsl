// Samples the second image by cubic interpolation where the flow so far points, and compares it with the first.
// Keys, Cubic convolution interpolation for digital image processing, 1981, with a = −½.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> first: array<f32>;
@group(0) @binding(2) var<storage, read> certainty_0: array<f32>;
@group(0) @binding(3) var<storage, read> second: array<f32>;
@group(0) @binding(4) var<storage, read> certainty_1: array<f32>;
@group(0) @binding(5) var<storage, read> flow: array<f32>; // two channels
@group(0) @binding(6) var<storage, read_write> mean: array<f32>;
@group(0) @binding(7) var<storage, read_write> change: array<f32>;
@group(0) @binding(8) var<storage, read_write> share: array<f32>;

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
    let columns = neighbours(u32(whole.x), params.width);
    let rows = stride * neighbours(u32(whole.y), params.height);
    let weights = cubic(f.x);
    let sampled = dot(
        cubic(f.y),
        vec4f(
            dot(weights, four(rows.x, columns)),
            dot(weights, four(rows.y, columns)),
            dot(weights, four(rows.z, columns)),
            dot(weights, four(rows.w, columns)),
        ),
    );
    let above = mix(certainty_1[rows.y + columns.y], certainty_1[rows.y + columns.z], f.x);
    let below = mix(certainty_1[rows.z + columns.y], certainty_1[rows.z + columns.z], f.x);
    let own = first[y * stride + x];
    let gray = select(own, sampled, inside);
    let shown = select(0.0, mix(above, below, f.y), inside);
    let both = certainty_0[y * stride + x] * shown;
    if id.x < stride && id.y < params.height {
        let i = id.y * stride + id.x;
        mean[i] = 0.5 * (own + gray);
        change[i] = gray - own;
        share[i] = both;
    }
}

// The neighbours i − 1 to i + 2 of a row of n, the ends repeated.
fn neighbours(i: u32, n: u32) -> vec4u {
    let last = n - 1u;
    return vec4u(max(i, 1u) - 1u, i, min(i + 1u, last), min(i + 2u, last));
}

fn four(row: u32, columns: vec4u) -> vec4f {
    return vec4f(second[row + columns.x], second[row + columns.y], second[row + columns.z], second[row + columns.w]);
}

// The weights of the four neighbours of a place that lies this far behind the second one.
fn cubic(f: f32) -> vec4f {
    return vec4f(
        f * (f * (1.0 - 0.5 * f) - 0.5),
        f * f * (1.5 * f - 2.5) + 1.0,
        f * (f * (2.0 - 1.5 * f) + 0.5),
        f * f * (0.5 * f - 0.5),
    );
}
