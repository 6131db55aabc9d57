// The weight with which each pixel's flow is held to its neighbours'.
// Rudin, Osher and Fatemi 1992; Bredies, Kunisch and Pock 2010.

struct Params {
    width: u32,
    height: u32,
    alpha: f32,  // weight of smoothness against that of the equations
    beta: f32,   // share of it that is left at the steepest edge of the image
    edge: f32,   // inverse square of the image's slope at which an edge takes half
    robust: f32, // squared deviation of the slopes up to which the weight is nearly constant
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>;
@group(0) @binding(2) var<storage, read> slope: array<f32>; // channels: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y
@group(0) @binding(3) var<storage, read> quad: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> smooth_weight: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let b = quad[y * stride + x].xy;
    let edge = params.beta + (1.0 - params.beta) / (1.0 + dot(b, b) * params.edge);
    let off = slopes(x, y) - expected(x, y);
    let weight = params.alpha * edge / sqrt(dot(off, off) + params.robust);
    if id.x < stride && id.y < params.height {
        smooth_weight[id.y * stride + id.x] = weight;
    }
}
