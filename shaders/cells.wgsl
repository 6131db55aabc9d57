// The flow on the view sphere averaged over square cells, in coordinates of the ideal pinhole.

struct Params {
    columns: u32,
    rows: u32,
    width: u32,
    height: u32,
    cell: u32, // side of a cell, pixels
    step: u32, // distance of samples, pixels
    focal: vec2f,
    centre: vec2f,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>;      // from the current frame back to the previous one, pixels
@group(0) @binding(2) var<storage, read> motion: array<vec4f>;
@group(0) @binding(3) var<storage, read> certainty: array<f32>; // of the current frame's pixels
@group(0) @binding(4) var<storage, read> confidence: array<f32>; // of the cells: along the expected direction, in every direction
@group(0) @binding(5) var<storage, read_write> cells: array<f32>; // channels: confidence along, x, y, dx/dt, dy/dt, confidence in every direction

const SPAN = vec2u(1u, 1u);
const MAX_SIDE = 64u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let out_stride = (params.columns + 3u) / 4u * 4u;
    let cell = min(id.xy, vec2u(params.columns, params.rows) - 1u);
    let corner = cell * params.cell;
    let size = vec2u(params.width, params.height);
    var weight = 0.0;
    var place = vec2f();
    var rate = vec2f();
    for (var j = 0u; j < min(params.cell, MAX_SIDE); j += params.step) {
        for (var i = 0u; i < min(params.cell, MAX_SIDE); i += params.step) {
            let pixel = corner + vec2u(i, j);
            let at = min(pixel, size - 1u);
            let base = 2u * at.y * stride + at.x;
            let d = vec2f(flow[base], flow[base + stride]);
            let current = vec3f((vec2f(at) - params.centre) / params.focal, 1.0);
            let known = all(pixel < size) && dot(d, d) <= 1e12;
            let shift = vec3f(select(vec2f(), d, known) / params.focal, 0.0);
            let unturned = current + shift;
            let previous = turned_back(unturned);
            let seen = midpoint_flow(current, previous, -shift - (previous - unturned));
            let m = seen.midpoint;
            // Directions beside or behind the camera have no place in the pinhole's plane.
            let w = select(0.0, certainty[at.y * stride + at.x], known && m.z > 0.01);
            let z = max(m.z, 0.01);
            weight += w;
            place += w * (m.xy / z);
            rate += w * ((seen.flow.xy - m.xy / z * seen.flow.z) / z);
        }
    }
    let share = 1.0 / max(weight, 1e-6);
    if id.x < out_stride && id.y < params.rows {
        let at = 6u * id.y * out_stride + id.x;
        let known = weight > 1e-3;
        cells[at] = select(0.0, confidence[2u * cell.y * out_stride + cell.x], known);
        cells[at + out_stride] = select(0.0, place.x * share, known);
        cells[at + 2u * out_stride] = select(0.0, place.y * share, known);
        cells[at + 3u * out_stride] = select(0.0, rate.x * share, known);
        cells[at + 4u * out_stride] = select(0.0, rate.y * share, known);
        cells[at + 5u * out_stride] = select(0.0, confidence[(2u * cell.y + 1u) * out_stride + cell.x], known);
    }
}
