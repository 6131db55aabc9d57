// Copies an expansion and its certainty, for the next pair.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> quad: array<vec4f>;
@group(0) @binding(2) var<storage, read> cross_term: array<f32>;
@group(0) @binding(3) var<storage, read> certainty: array<f32>;
@group(0) @binding(4) var<storage, read_write> kept_quad: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> kept_rest: array<f32>; // all rows of the cross term, then all rows of the certainty

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let i = id.y * stride + id.x;
    kept_quad[i] = quad[i];
    kept_rest[i] = cross_term[i];
    kept_rest[i + stride * params.height] = certainty[i];
}
