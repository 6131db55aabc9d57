// Looming of each cell: the nearness rate and the divergence of the flow on the view sphere.

struct Params {
    columns: u32,
    rows: u32,
    radius: u32,       // radius of the divergence's window, cells
    inner: u32,        // radius of the nearness rate's window, cells
    pitch: vec2f,      // distance of cells in the pinhole's plane
    origin: vec2f,     // the first cell's centre there
    noise: f32,        // standard error of a cell's rate, per frame, in the pinhole's plane
    least_confidence: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> cells: array<f32>; // channels: confidence along, x, y, dx/dt, dy/dt, confidence in every direction
@group(0) @binding(2) var<storage, read> motion: array<vec4f>; // the last: direction of motion, its standard error
@group(0) @binding(3) var<storage, read_write> looming: array<f32>; // channels: N, div, standard error of N, confidence

const SPAN = vec2u(1u, 1u);
const MAX_SIDE = 33u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.columns + 3u) / 4u * 4u;
    let cell = min(id.xy, vec2u(params.columns, params.rows) - 1u);
    let origin = params.origin + vec2f(cell) * params.pitch;
    let side = 2u * params.radius + 1u;
    var count = 0.0;
    var sum = 0.0;
    var mean = vec2f();
    var rate = vec2f();
    var spread = vec3f();      // Σw xx, xy, yy
    var slope_x = vec2f();     // Σw x rate
    var slope_y = vec2f();
    var square = 0.0;          // Σw rate·rate
    var ideal = vec2f();       // Σw g
    var ideal_square = 0.0;
    var ideal_rate = 0.0;
    var inner_sum = 0.0;
    var inner_square = 0.0;
    var inner_rate = 0.0;
    for (var j = 0u; j < min(side, MAX_SIDE); j++) {
        for (var i = 0u; i < min(side, MAX_SIDE); i++) {
            // Differences that wrap around are beyond the last column and row.
            let at = cell + vec2u(i, j) - params.radius;
            let there = at.x < params.columns && at.y < params.rows;
            let base = select(0u, 6u * at.y * stride + at.x, there);
            let confidence = cells[base];
            let w = select(0.0, confidence, there && confidence >= params.least_confidence);
            let place = vec2f(cells[base + stride], cells[base + 2u * stride]);
            let r = vec2f(cells[base + 3u * stride], cells[base + 4u * stride]);
            let x = place - origin;
            count += select(0.0, 1.0, w > 0.0);
            sum += w;
            mean += w * x;
            rate += w * r;
            spread += w * vec3f(x.x * x.x, x.x * x.y, x.y * x.y);
            slope_x += w * x.x * r;
            slope_y += w * x.y * r;
            square += w * dot(r, r);
            let g = expected(place);
            ideal += w * g;
            ideal_square += w * dot(g, g);
            ideal_rate += w * dot(g, r);
            let near = i + params.inner >= params.radius && i <= params.radius + params.inner
                && j + params.inner >= params.radius && j <= params.radius + params.inner;
            let w_near = select(0.0, w, near);
            inner_sum += w_near;
            inner_square += w_near * dot(g, g);
            inner_rate += w_near * dot(g, r);
        }
    }
    let share = 1.0 / max(sum, 1e-20);
    mean *= share;
    rate *= share;
    ideal *= share;
    let c_xx = spread.x * share - mean.x * mean.x;
    let c_xy = spread.y * share - mean.x * mean.y;
    let c_yy = spread.z * share - mean.y * mean.y;
    let determinant = c_xx * c_yy - c_xy * c_xy;
    let c_x = slope_x * share - mean.x * rate;
    let c_y = slope_y * share - mean.y * rate;
    let cell_area = params.pitch.x * params.pitch.y;
    let enough = 2.0 * count >= f32(side * side) && determinant > 0.05 * cell_area * cell_area && inner_sum > 0.0;
    let inverse = 1.0 / max(determinant, 1e-30);
    let by_x = (c_yy * c_x - c_xy * c_y) * inverse;
    let by_y = (c_xx * c_y - c_xy * c_x) * inverse;
    let here = rate - mean.x * by_x - mean.y * by_y;
    let divergence = by_x.x + by_y.y - 3.0 * dot(origin, here) / (1.0 + dot(origin, origin));

    // The residual of the affine motion is the noise of the rates, and edges in depth.
    let left = square * share - dot(rate, rate) - dot(by_x, c_x) - dot(by_y, c_y);
    let variance = params.noise * params.noise + 0.5 * max(left, 0.0);
    // From the flow's length relative to its distance from the direction of motion: accurate far from it.
    let far = inner_rate / max(inner_square, 1e-20);
    let far_noise = variance / max(inner_square, 1e-20);
    // From its growth within the window: accurate near it, where the surface's slant does not matter.
    let growth_square = max(ideal_square - sum * dot(ideal, ideal), 1e-20);
    let growth = (ideal_rate - sum * dot(ideal, rate)) / growth_square;
    let growth_noise = variance / growth_square;
    let first = (far * growth_noise + growth * far_noise) / (far_noise + growth_noise);
    let n_square = 1.0 + dot(origin, origin);
    let sine_square = inner_square / max(inner_sum, 1e-20) / n_square;
    let doubt = motion[3].w * motion[3].w / max(sine_square, 1e-12);
    let far_variance = far_noise + first * first * doubt;
    let growth_variance = growth_noise + first * first * sine_square;
    let total = far_variance + growth_variance;
    let nearness_rate = (far * growth_variance + growth * far_variance) / max(total, 1e-30);
    let error = sqrt(far_variance * growth_variance / max(total, 1e-30));
    let confidence = sum / f32(side * side);
    if id.x < stride && id.y < params.rows {
        let at = 4u * id.y * stride + id.x;
        looming[at] = select(0.0, nearness_rate, enough);
        looming[at + stride] = select(0.0, divergence, enough);
        looming[at + 2u * stride] = select(0.0, error, enough);
        looming[at + 3u * stride] = select(0.0, confidence, enough);
    }
}

// The rate at this place of the pinhole's plane where the nearness rate is 1.
fn expected(place: vec2f) -> vec2f {
    let v = motion[3].xyz;
    return sqrt(1.0 + dot(place, place)) * (v.z * place - v.xy);
}
