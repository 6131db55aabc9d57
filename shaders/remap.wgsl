// A picture read bilinearly at given places.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> picture: array<f32>;
@group(0) @binding(2) var<storage, read> map: array<vec4f>; // channels: x and y in the picture
@group(0) @binding(3) var<storage, read_write> out: array<vec4f>;

const SPAN = vec2u(4u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let last = vec2f(f32(params.in_width), f32(params.in_height)) - 1.0;
    let column = min(id.x, stride - 1u);
    let row = min(id.y, params.height - 1u);
    // Not-a-number compares as false, and is read at the border.
    let x = map[2u * row * stride + column];
    let y = map[(2u * row + 1u) * stride + column];
    let px = clamp(select(vec4f(), x, x >= vec4f()), vec4f(), vec4f(last.x));
    let py = clamp(select(vec4f(), y, y >= vec4f()), vec4f(), vec4f(last.y));
    let value = vec4f(
        between(px.x, py.x), between(px.y, py.y), between(px.z, py.z), between(px.w, py.w),
    );
    if id.x < stride && id.y < params.height {
        out[row * stride + column] = value;
    }
}

fn between(x: f32, y: f32) -> f32 {
    let stride = (params.in_width + 3u) / 4u * 4u;
    let left = u32(x);
    let top = u32(y);
    let right = min(left + 1u, params.in_width - 1u);
    let above = top * stride;
    let below = min(top + 1u, params.in_height - 1u) * stride;
    let f = vec2f(x - f32(left), y - f32(top));
    return mix(
        mix(picture[above + left], picture[above + right], f.x),
        mix(picture[below + left], picture[below + right], f.x),
        f.y,
    );
}
