// Adds a coarser level's correction of a predicted flow, less a threshold, to the prediction of this level.
// Donoho, De-noising by soft-thresholding, 1995.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
    scale: f32,     // of displacements from the coarser level to this one
    threshold: f32, // magnitude, in pixels of the coarser level, that is taken off a correction
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> prediction: array<f32>;
@group(0) @binding(2) var<storage, read> coarse_flow: array<f32>;
@group(0) @binding(3) var<storage, read> coarse_prediction: array<f32>;
@group(0) @binding(4) var<storage, read> place_x: array<vec2f>; // whole and fractional column to read at
@group(0) @binding(5) var<storage, read> place_y: array<vec2f>;
@group(0) @binding(6) var<storage, read_write> flow: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let column = place_x[x];
    let line = place_y[y];
    let left = u32(column.x);
    let right = min(left + 1u, params.in_width - 1u);
    let above = u32(line.x);
    let below = min(above + 1u, params.in_height - 1u);
    let upper = mix(change(left, above), change(right, above), column.y);
    let lower = mix(change(left, below), change(right, below), column.y);
    let c = mix(upper, lower, line.y);
    let magnitude = sqrt(dot(c, c));
    let share = params.scale * max(magnitude - params.threshold, 0.0) / max(magnitude, 1e-9);
    let i = 2u * y * stride + x;
    let d = vec2f(prediction[i], prediction[i + stride]) + share * c;
    if id.x < stride && id.y < params.height {
        flow[2u * id.y * stride + id.x] = d.x;
        flow[(2u * id.y + 1u) * stride + id.x] = d.y;
    }
}

// What the coarser level has changed.
fn change(x: u32, y: u32) -> vec2f {
    let stride = (params.in_width + 3u) / 4u * 4u;
    let i = 2u * y * stride + x;
    return vec2f(coarse_flow[i] - coarse_prediction[i], coarse_flow[i + stride] - coarse_prediction[i + stride]);
}
