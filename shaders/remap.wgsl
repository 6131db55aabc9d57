// Samples an image bilinearly at the places of a map; its border is replicated.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> picture: array<f32>;
@group(0) @binding(2) var<storage, read> map: array<f32>; // x and y
@group(0) @binding(3) var<storage, read_write> remapped: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let row = 2u * id.y * stride + min(id.x, params.width - 1u);
    let at = between(vec2f(map[row], map[row + stride]));
    remapped[id.y * stride + id.x] = mix(
        mix(picture[at.above + at.left], picture[at.above + at.right], at.fraction.x),
        mix(picture[at.below + at.left], picture[at.below + at.right], at.fraction.x),
        at.fraction.y,
    );
}
