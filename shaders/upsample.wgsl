// Samples a coarser level's flow, or another image of some channels, bilinearly at this level's pixels and scales it.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
    scale: f32, // of the values
    channels: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> coarse: array<vec4f>;
@group(0) @binding(2) var<storage, read> place_x: array<vec2f>; // whole and fractional column to read at
@group(0) @binding(3) var<storage, read> place_y: array<vec2f>;
@group(0) @binding(4) var<storage, read_write> flow: array<vec4f>;

const SPAN = vec2u(4u, 1u);

@compute @workgroup_size(32, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let x0 = 4u * id.x;
    let last = params.width - 1u;
    let a = place_x[x0];
    let b = place_x[min(x0 + 1u, last)];
    let c = place_x[min(x0 + 2u, last)];
    let d = place_x[min(x0 + 3u, last)];
    let y = place_y[id.y];
    // Four neighbours here lie within four neighbours there, which with the next one are within eight.
    let first = u32(a.x) / 4u;
    let left = vec4u(u32(a.x), u32(b.x), u32(c.x), u32(d.x)) - 4u * first;
    let right = min(left + 1u, vec4u(params.in_width - 1u - 4u * first));
    let fraction = vec4f(a.y, b.y, c.y, d.y);
    for (var channel = 0u; channel < min(params.channels, 8u); channel++) {
        let here = columns(first, y, channel);
        let next = columns(first + 1u, y, channel);
        let mixed = mix(pick(here, next, left), pick(here, next, right), fraction);
        flow[(params.channels * id.y + channel) * stride + id.x] = params.scale * mixed;
    }
}

// Four columns of the coarser level, between its rows.
fn columns(four: u32, y: vec2f, channel: u32) -> vec4f {
    let stride = (params.in_width + 3u) / 4u;
    let x4 = min(four, stride - 1u);
    let above = u32(y.x);
    let below = min(above + 1u, params.in_height - 1u);
    return mix(coarse[(params.channels * above + channel) * stride + x4], coarse[(params.channels * below + channel) * stride + x4], y.y);
}

// The columns with the given numbers, of eight.
fn pick(here: vec4f, next: vec4f, number: vec4u) -> vec4f {
    return select(of_four(here, number), of_four(next, number - 4u), number >= vec4u(4u));
}

fn of_four(v: vec4f, number: vec4u) -> vec4f {
    let low = select(vec4f(v.x), vec4f(v.y), number == vec4u(1u));
    let high = select(vec4f(v.z), vec4f(v.w), number == vec4u(3u));
    return select(low, high, number >= vec4u(2u));
}
