// The mean of a plane over each block of 4 × 4 pixels, and around these blocks a ring of zeros.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> plane: array<f32>;
@group(0) @binding(2) var<storage, read_write> blocks: array<f32>;

// Blocks of zeros before the first block and after the last.
const RING = 4u;

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let columns = (params.width + 3u) / 4u + 2u * RING;
    let rows = (params.height + 3u) / 4u + 2u * RING;
    let out_stride = (columns + 3u) / 4u * 4u;
    // The ring reads the blocks beside it, and writes 0.
    let column = clamp(id.x, RING, columns - RING - 1u);
    let row = clamp(id.y, RING, rows - RING - 1u);
    var sum = 0.0;
    for (var j = 0u; j < 4u; j++) {
        let y = min(4u * (row - RING) + j, params.height - 1u);
        for (var i = 0u; i < 4u; i++) {
            sum += plane[y * stride + min(4u * (column - RING) + i, params.width - 1u)];
        }
    }
    let inside = column == id.x && row == id.y;
    if id.x < out_stride && id.y < rows {
        blocks[id.y * out_stride + id.x] = select(0.0, sum / 16.0, inside);
    }
}
