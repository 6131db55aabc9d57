// A coarser level's flow read bilinearly at this level's pixels and scaled to its pixel size.

struct Params {
    width: u32,
    height: u32,
    in_width: u32,
    in_height: u32,
    scale: f32, // of the displacements
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> coarse: array<f32>;
@group(0) @binding(2) var<storage, read> place_x: array<vec2f>; // whole and fractional column to read at
@group(0) @binding(3) var<storage, read> place_y: array<vec2f>;
@group(0) @binding(4) var<storage, read_write> flow: array<f32>;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    if id.x >= stride || id.y >= params.height {
        return;
    }
    let x = place_x[min(id.x, params.width - 1u)];
    let y = place_y[id.y];
    flow[2u * id.y * stride + id.x] = params.scale * sample(x, y, 0u);
    flow[(2u * id.y + 1u) * stride + id.x] = params.scale * sample(x, y, 1u);
}

fn sample(x: vec2f, y: vec2f, channel: u32) -> f32 {
    let stride = (params.in_width + 3u) / 4u * 4u;
    let left = u32(x.x);
    let right = min(left + 1u, params.in_width - 1u);
    let above = (2u * u32(y.x) + channel) * stride;
    let below = (2u * min(u32(y.x) + 1u, params.in_height - 1u) + channel) * stride;
    return mix(
        mix(coarse[above + left], coarse[above + right], x.y),
        mix(coarse[below + left], coarse[below + right], x.y),
        y.y,
    );
}
