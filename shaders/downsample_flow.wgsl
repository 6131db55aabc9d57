// Reduces a given flow to a coarser level: the mean over each coarse pixel's area, scaled to the level's pixel size.
// A displacement that is not finite or over 10⁹ is unknown and counts as zero.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
    scale: f32, // of the displacements
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> fine: array<f32>;
@group(0) @binding(2) var<storage, read> cover_x: array<vec4f>; // first column, number of columns, weight of the first, of the last
@group(0) @binding(3) var<storage, read> cover_y: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> flow: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_COVER = 16384u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let in_stride = (params.in_width + 3u) / 4u * 4u;
    let x = cover_x[min(id.x, params.width - 1u)];
    let y = cover_y[id.y];
    var sum = vec2f();
    var weights = 0.0;
    for (var j = 0u; j < min(u32(y.y), MAX_COVER); j++) {
        let row = 2u * (u32(y.x) + j) * in_stride;
        let w_y = weight(j, y);
        for (var i = 0u; i < min(u32(x.y), MAX_COVER); i++) {
            let column = u32(x.x) + i;
            let w = w_y * weight(i, x);
            let d = vec2f(fine[row + column], fine[row + in_stride + column]);
            sum += w * select(vec2f(), d, all(abs(d) <= vec2f(1e9)));
            weights += w;
        }
    }
    flow[2u * id.y * stride + id.x] = params.scale * sum.x / weights;
    flow[(2u * id.y + 1u) * stride + id.x] = params.scale * sum.y / weights;
}

fn weight(i: u32, cover: vec4f) -> f32 {
    return select(select(1.0, cover.w, i + 1u == u32(cover.y)), cover.z, i == 0u);
}
