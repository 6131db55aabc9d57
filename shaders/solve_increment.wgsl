// As solve.wgsl, with the solution added to the flow so far.
// Farnebäck 2003, section 3.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
    regular: f32, // added to the determinant
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<vec4f>;
@group(0) @binding(2) var<uniform> window: array<vec4f, 1024>; // zeros up to a multiple of four, weights, then zeros
@group(0) @binding(3) var<storage, read> so_far: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> flow: array<vec4f>;

const SPAN = vec2u(16u, 1u);

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let four = 4u * id.x;
    let y = min(id.y, params.height - 1u);
    let s = averages(four, y);
    store(four, id.y, s.four_0);
    store(four + 1u, id.y, s.four_1);
    store(four + 2u, id.y, s.four_2);
    store(four + 3u, id.y, s.four_3);
}

fn store(four: u32, y: u32, equations: Five) {
    let stride = (params.width + 3u) / 4u;
    let row = 2u * min(y, params.height - 1u) * stride + min(four, stride - 1u);
    let d = solution(equations, params.regular);
    let u = repeat_last(so_far[row] + d.u, 4u * four, params.width);
    let v = repeat_last(so_far[row + stride] + d.v, 4u * four, params.width);
    if four < stride && y < params.height {
        flow[2u * y * stride + four] = u;
        flow[(2u * y + 1u) * stride + four] = v;
    }
}
