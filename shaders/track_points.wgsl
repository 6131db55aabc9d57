// Moves the windows of points in the next image until it shows there what the windows hold: Gauss-Newton iterations on
// one level of the pyramid. Bouguet 2001.
//
// A workgroup takes one point. Its invocations take every 64th sample each.

struct Params {
    width: u32,
    height: u32,
    window_width: u32,
    window_height: u32,
    scale: f32,           // from pixels of the full image to those of this one
    iterations: u32,
    epsilon: f32,         // the squared displacement that ends the iterations
    min_eigenvalue: f32,  // of the mean structure tensor
    min_determinant: f32, // of the same
    finest: u32,          // 1 on the full image: only there a point is lost, and the error is computed
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> image: array<f32>;
@group(0) @binding(2) var<storage, read> patches: array<f32>; // a row for each point: channels I, I_x, I_y
@group(0) @binding(3) var<storage, read> tensors: array<vec4f>;
@group(0) @binding(4) var<storage, read> points: array<vec4f>; // x, y, status, error
@group(0) @binding(5) var<storage, read_write> tracked: array<vec4f>;

const TILE = vec2u(4u, 1u);
const LANES = 64u;
const MAX_SAMPLES = 4096u;
const MAX_ITERATIONS = 100u;

@compute @workgroup_size(64, 1)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let point = points[group.y];
    let tensor = tensors[group.y];
    let half = 0.5 * (vec2f(f32(params.window_width), f32(params.window_height)) - 1.0);
    let difference = tensor.x - tensor.z;
    let smaller = 0.5 * (tensor.x + tensor.z - sqrt(difference * difference + 4.0 * tensor.y * tensor.y));
    let determinant = tensor.x * tensor.z - tensor.y * tensor.y;
    let clear = point.z > 0.0 && tensor.w > 0.0
        && smaller >= params.min_eigenvalue && determinant >= params.min_determinant;
    let inverse = 1.0 / select(1.0, determinant, clear);
    var found = point.xy * params.scale;
    var place = found - half;
    var before = vec2f();
    if clear {
        for (var k = 0u; k < min(params.iterations, MAX_ITERATIONS); k++) {
            if !meets(place) {
                break;
            }
            let b = misfit(local.x, group.y, place).xy;
            let shift = inverse * vec2f(tensor.y * b.y - tensor.z * b.x, tensor.y * b.x - tensor.x * b.y);
            place += shift;
            found = place + half;
            if dot(shift, shift) <= params.epsilon {
                break;
            }
            // Steps to and fro: the place between them.
            if k > 0u && all(abs(shift + before) < vec2f(0.01)) {
                found -= 0.5 * shift;
                break;
            }
            before = shift;
        }
    }
    var status = point.z;
    var error = 0.0;
    if params.finest == 1u {
        let end = found - half;
        let left = misfit(local.x, group.y, end).z;
        let kept = clear && meets(end);
        status = select(0.0, point.z, kept);
        error = select(0.0, left, kept);
    }
    if local.x == 0u {
        let result = select(point.xy, found / params.scale, clear);
        tracked[group.y] = vec4f(result, status, error);
    }
}

// Whether a window with this upper left corner meets the image.
fn meets(place: vec2f) -> bool {
    let whole = floor(place);
    let window = vec2f(f32(params.window_width), f32(params.window_height));
    // NaN does not.
    return all(whole >= -window) && all(whole < vec2f(f32(params.width), f32(params.height)));
}

// The means over the window of I_x d, I_y d and |d|, with d the difference of the image from the patch.
fn misfit(lane: u32, point: u32, place: vec2f) -> vec4f {
    let area = params.window_width * params.window_height;
    let stride = (area + 3u) / 4u * 4u;
    let inside = meets(place);
    let whole = floor(place);
    let corner = vec2i(select(vec2f(), whole, inside));
    let part = place - whole;
    let end = corner + vec2i(vec2u(params.window_width, params.window_height));
    // Most windows lie inside, where nothing is mirrored.
    let interior = all(corner >= vec2i()) && all(end < vec2i(vec2u(params.width, params.height)));
    var sum = vec4f();
    if inside {
        for (var k = lane; k < min(area, MAX_SAMPLES); k += LANES) {
            let at = 3u * point * stride + k;
            let d = sampled(corner + offset(k), part, interior) - patches[at];
            sum += vec4f(patches[at + stride] * d, patches[at + 2u * stride] * d, abs(d), 0.0);
        }
    }
    return lane_sum(lane, sum) / f32(area);
}

fn sampled(pixel: vec2i, part: vec2f, interior: bool) -> f32 {
    let stride = (params.width + 3u) / 4u * 4u;
    let n = vec2i(i32(params.width), i32(params.height));
    var left = u32(pixel.x);
    var right = left + 1u;
    var above = stride * u32(pixel.y);
    var below = above + stride;
    if !interior {
        left = reflect_101(pixel.x, n.x);
        right = reflect_101(pixel.x + 1, n.x);
        above = stride * reflect_101(pixel.y, n.y);
        below = stride * reflect_101(pixel.y + 1, n.y);
    }
    let across = vec2f(1.0 - part.x, part.x);
    return (1.0 - part.y) * dot(across, vec2f(image[above + left], image[above + right]))
        + part.y * dot(across, vec2f(image[below + left], image[below + right]));
}
