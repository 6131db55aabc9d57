// The map of undistortion: the place of each pixel of an ideal, rotated image in the raw one, and the certainty there.

struct Params {
    width: u32,
    height: u32,
    in_width: u32, // of the raw image
    in_height: u32,
    out_focal: vec2f,
    out_centre: vec2f,
    raw_focal: vec2f,
    raw_centre: vec2f,
    lens_a: vec4f, // k1 k2 p1 p2
    lens_b: vec4f, // k3 k4 k5 k6
    limit: vec2f,  // of r², up to which the lens is one to one, and how steeply the certainty falls to it
    middle: vec2f, // of the raw image
    margin: vec2f, // pixels within its border
    masked: u32, // 0 if the mask is 1 everywhere
    padding: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> motion: array<vec4f>;
@group(0) @binding(2) var<storage, read> mask: array<f32>;
@group(0) @binding(3) var<storage, read_write> map: array<f32>;
@group(0) @binding(4) var<storage, read_write> certainty: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let pixel = vec2f(f32(min(id.x, params.width - 1u)), f32(id.y));
    let out = vec3f((pixel - params.out_centre) / params.out_focal, 1.0);
    let seen = ideal(turned(out));
    let place = near(params.raw_focal * distort(seen.place, params.lens_a, params.lens_b) + params.raw_centre);
    let last = vec2f(f32(params.in_width - 1u), f32(params.in_height - 1u));
    let clamped = clamp_to_frame(place, last);
    // From 0 one pixel outside to 1 a margin inside.
    let within = min(place, last - place);
    let covered = clamp((within + 1.0) / (params.margin + 1.0), vec2f(), vec2f(1.0));
    map[2u * id.y * stride + id.x] = clamped.x;
    map[(2u * id.y + 1u) * stride + id.x] = clamped.y;
    certainty[id.y * stride + id.x] = seen.share * covered.x * covered.y * select(1.0, mask_at(clamped), params.masked != 0u);
}

struct Ideal {
    place: vec2f,
    share: f32, // visibility, 0 to 1
}

// The place at which an ideal pinhole shows a ray. One that the lens does not show is put on the circle where that
// begins, so that rounding does not make it jump.
fn ideal(ray: vec3f) -> Ideal {
    let across = dot(ray.xy, ray.xy);
    if ray.z > 0.0 && across < params.limit.x * ray.z * ray.z {
        let place = ray.xy / ray.z;
        return Ideal(place, clamp((params.limit.x - dot(place, place)) * params.limit.y, 0.0, 1.0));
    }
    let known = across > 1e-30 && across < 1e30;
    let scale = sqrt(params.limit.x / select(1.0, across, known));
    return Ideal(select(vec2f(), ray.xy * scale, known), 0.0);
}

// A place more than a pixel outside the frame is moved towards its centre until it is one pixel outside.
fn near(place: vec2f) -> vec2f {
    let d = place - params.middle;
    let times = abs(d) / (params.middle + 1.0);
    let most = max(times.x, times.y);
    return select(place, params.middle + d / max(most, 1.0), most > 1.0);
}

// The mask, sampled bilinearly.
fn mask_at(place: vec2f) -> f32 {
    let at = between(place);
    return mix(
        mix(share(mask[at.above + at.left]), share(mask[at.above + at.right]), at.fraction.x),
        mix(share(mask[at.below + at.left]), share(mask[at.below + at.right]), at.fraction.x),
        at.fraction.y,
    );
}

// A value clamped to the range 0 to 1. NaN becomes 0.
fn share(value: f32) -> f32 {
    return select(0.0, min(value, 1.0), value > 0.0);
}
