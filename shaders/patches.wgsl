// The windows around points of an image, sampled bilinearly: gray level and gradient (Scharr 2000) of each sample, and
// the mean of the gradients' structure tensor.
//
// A workgroup takes one point. Its invocations take every 64th sample each.

struct Params {
    width: u32,
    height: u32,
    window_width: u32,
    window_height: u32,
    scale: f32, // from pixels of the full image to those of this one
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> image: array<f32>;
@group(0) @binding(2) var<storage, read> points: array<vec4f>; // x, y, whether there is a point
@group(0) @binding(3) var<storage, read_write> patches: array<f32>; // a row for each point: channels I, I_x, I_y
@group(0) @binding(4) var<storage, read_write> tensors: array<vec4f>; // xx, xy, yy, whether the window meets the image

const TILE = vec2u(4096u, 1u);
const LANES = 64u;
const MAX_SAMPLES = 4096u;

@compute @workgroup_size(64, 1)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let point = points[group.y];
    let area = params.window_width * params.window_height;
    let stride = (area + 3u) / 4u * 4u;
    let window = vec2f(f32(params.window_width), f32(params.window_height));
    let size = vec2f(f32(params.width), f32(params.height));
    let place = point.xy * params.scale - 0.5 * (window - 1.0);
    let whole = floor(place);
    // NaN is not there either.
    let there = point.z > 0.0 && all(whole >= -window) && all(whole < size);
    let corner = vec2i(select(vec2f(), whole, there));
    let part = place - whole;
    let end = corner + vec2i(vec2u(params.window_width, params.window_height));
    // Most windows lie inside, where nothing is mirrored.
    let interior = all(corner >= vec2i(1)) && all(end + 1 < vec2i(vec2u(params.width, params.height)));
    var sum = vec4f();
    for (var k = local.x; k < min(stride, MAX_SAMPLES); k += LANES) {
        // The surplus repeats the last sample.
        let sample = min(k, area - 1u);
        var value = vec3f();
        if there {
            value = sampled(corner + offset(sample), part, interior);
        }
        let at = 3u * group.y * stride + k;
        patches[at] = value.x;
        patches[at + stride] = value.y;
        patches[at + 2u * stride] = value.z;
        sum += select(vec4f(), vec4f(value.yyz * value.yzz, 0.0), k < area);
    }
    let all_samples = lane_sum(local.x, sum) / f32(area);
    if local.x == 0u {
        tensors[group.y] = vec4f(all_samples.xyz, select(0.0, 1.0, there));
    }
}

// Gray level and gradient between a pixel and its neighbours to the right and below.
fn sampled(pixel: vec2i, part: vec2f, interior: bool) -> vec3f {
    let n = vec2i(i32(params.width), i32(params.height));
    let first = vec2u(pixel - 1);
    var columns = first.x + vec4u(0u, 1u, 2u, 3u);
    var rows = first.y + vec4u(0u, 1u, 2u, 3u);
    if !interior {
        columns = four_mirrored(pixel.x - 1, n.x);
        rows = four_mirrored(pixel.y - 1, n.y);
    }
    rows *= (params.width + 3u) / 4u * 4u;
    let a = four(columns, rows.x);
    let b = four(columns, rows.y);
    let c = four(columns, rows.z);
    let d = four(columns, rows.w);
    // Gradients of the four pixels, 32 times too large: those of the upper two, those of the lower two.
    let upper_x = 3.0 * ((a.zw - a.xy) + (c.zw - c.xy)) + 10.0 * (b.zw - b.xy);
    let lower_x = 3.0 * ((b.zw - b.xy) + (d.zw - d.xy)) + 10.0 * (c.zw - c.xy);
    let upper = c - a;
    let lower = d - b;
    let upper_y = 3.0 * (upper.xy + upper.zw) + 10.0 * upper.yz;
    let lower_y = 3.0 * (lower.xy + lower.zw) + 10.0 * lower.yz;
    let across = vec2f(1.0 - part.x, part.x);
    let down = vec2f(1.0 - part.y, part.y);
    // Outside the image there is no gradient.
    let xs = vec2i(pixel.x, pixel.x + 1);
    let ys = vec2i(pixel.y, pixel.y + 1);
    let across_within = select(vec2f(), across, (xs >= vec2i()) & (xs < n.xx));
    let down_within = select(vec2f(), down, (ys >= vec2i()) & (ys < n.yy));
    return vec3f(
        down.x * dot(across, b.yz) + down.y * dot(across, c.yz),
        0.03125 * (down_within.x * dot(across_within, upper_x) + down_within.y * dot(across_within, lower_x)),
        0.03125 * (down_within.x * dot(across_within, upper_y) + down_within.y * dot(across_within, lower_y)),
    );
}

fn four_mirrored(first: i32, n: i32) -> vec4u {
    return vec4u(
        reflect_101(first, n), reflect_101(first + 1, n), reflect_101(first + 2, n), reflect_101(first + 3, n),
    );
}

fn four(columns: vec4u, start: u32) -> vec4f {
    return vec4f(
        image[start + columns.x], image[start + columns.y], image[start + columns.z], image[start + columns.w],
    );
}
