// The confidence of each cell's flow, along the direction that it is expected to have and in every direction.

struct Params {
    columns: u32,
    rows: u32,
    pitch: vec2f,  // distance of cells in the pinhole's plane
    origin: vec2f, // the first cell's centre there
    focal: vec2f,
    known_rad: f32, // the largest error of the direction of motion at which the flow has an expected direction
    near: f32,      // the least distance from it at which there is one, in the pinhole's plane
}

@group(0) @binding(0) var<uniform> params: Params;
// Channels: AᵀA (xx, xy, yy), the square of the residual of Δb, the share that both frames show.
@group(0) @binding(1) var<storage, read> evidence: array<f32>;
@group(0) @binding(2) var<storage, read> motion: array<vec4f>; // the last: direction of motion, its standard error
@group(0) @binding(3) var<storage, read_write> confidence: array<f32>; // channels: along, every

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.columns + 3u) / 4u * 4u;
    let cell = min(id.xy, vec2u(params.columns, params.rows) - 1u);
    let here = 5u * cell.y * stride + cell.x;
    let g = vec3f(evidence[here], evidence[here + stride], evidence[here + 2u * stride]);
    let rest = evidence[here + 3u * stride];
    let coverage = evidence[here + 4u * stride];
    let every = confidence_of(vec4f(g.x), vec4f(g.y), vec4f(g.z), vec4f(rest), vec4f(coverage)).x;
    let v = motion[3];
    let away = v.z * (params.origin + vec2f(cell) * params.pitch) - v.xy;
    let expected = v.w < params.known_rad && dot(away, away) > params.near * params.near;
    let along = max(confidence_along(g, rest, coverage, away * params.focal), every);
    if id.x < stride && id.y < params.rows {
        let out = 2u * id.y * stride + id.x;
        confidence[out] = select(every, along, expected);
        confidence[out + stride] = every;
    }
}
