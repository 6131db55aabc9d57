// How far the flow can be trusted: rows of the averaged evidence averaged in turn, and 1 against the standard error that
// they predict.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> columns: array<vec4f>; // channels: G_xx, G_xy, G_yy, ‖Δb‖², coverage
@group(0) @binding(2) var<storage, read> window: array<vec4f>;  // as of solve
@group(0) @binding(3) var<storage, read_write> confidence: array<vec4f>;

const SPAN = vec2u(16u, 1u);

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let four = 4u * id.x;
    let y = min(id.y, params.height - 1u);
    let g_xx = sums(four, y, 0u);
    let g_xy = sums(four, y, 1u);
    let g_yy = sums(four, y, 2u);
    let rest = sums(four, y, 3u);
    let coverage = sums(four, y, 4u);
    store(four, id.y, g_xx.a, g_xy.a, g_yy.a, rest.a, coverage.a);
    store(four + 1u, id.y, g_xx.b, g_xy.b, g_yy.b, rest.b, coverage.b);
    store(four + 2u, id.y, g_xx.c, g_xy.c, g_yy.c, rest.c, coverage.c);
    store(four + 3u, id.y, g_xx.d, g_xy.d, g_yy.d, rest.d, coverage.d);
}

fn store(four: u32, y: u32, g_xx: vec4f, g_xy: vec4f, g_yy: vec4f, rest: vec4f, coverage: vec4f) {
    let stride = (params.width + 3u) / 4u;
    let value = trusted(g_xx, g_xy, g_yy, rest, coverage);
    if four < stride && y < params.height {
        confidence[y * stride + four] = repeat_last(value, 4u * four, params.width);
    }
}
