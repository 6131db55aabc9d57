// The mean of a plane over each cell's samples, weighted by their certainty.

struct Params {
    columns: u32,
    rows: u32,
    width: u32,
    height: u32,
    cell: u32, // side of a cell, pixels
    step: u32, // distance of samples, pixels
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> plane: array<f32>;
@group(0) @binding(2) var<storage, read> certainty: array<f32>;
@group(0) @binding(3) var<storage, read_write> mean: array<f32>; // two equal channels

const SPAN = vec2u(1u, 1u);
const MAX_SIDE = 64u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let out_stride = (params.columns + 3u) / 4u * 4u;
    let cell = min(id.xy, vec2u(params.columns, params.rows) - 1u);
    let size = vec2u(params.width, params.height);
    var count = 0.0;
    var sum = 0.0;
    for (var j = 0u; j < min(params.cell, MAX_SIDE); j += params.step) {
        for (var i = 0u; i < min(params.cell, MAX_SIDE); i += params.step) {
            let pixel = cell * params.cell + vec2u(i, j);
            let there = all(pixel < size);
            let at = min(pixel, size - 1u);
            let here = at.y * stride + at.x;
            count += select(0.0, 1.0, there);
            sum += select(0.0, plane[here] * certainty[here], there);
        }
    }
    if id.x < out_stride && id.y < params.rows {
        mean[2u * id.y * out_stride + id.x] = sum / count;
        mean[(2u * id.y + 1u) * out_stride + id.x] = sum / count;
    }
}
