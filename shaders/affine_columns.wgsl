// Averages columns of five channels, and their moments along the column: the vertical half of the sums of an affine motion
// model. Rows outside the image have no weight.
// Farnebäck 2003, section 4, parameterized displacement fields.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
    step: f32, // the length of a pixel, relative to the radius
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> equations: array<vec4f>; // channels: G_xx, G_xy, G_yy, q_x, q_y
@group(0) @binding(2) var<uniform> window: array<vec4f, 1024>;    // weights from −radius to radius, then zeros
@group(0) @binding(3) var<storage, read_write> columns: array<vec4f>; // all times 1, all times y, G times y²

const SPAN = vec2u(4u, 1u);
const MAX_TAPS = 1025u;

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let x = min(id.x, stride - 1u);
    var one: array<vec4f, 5>;
    var first: array<vec4f, 5>;
    var second: array<vec4f, 3>;
    for (var k = 0u; k < min(2u * params.radius + 1u, MAX_TAPS); k++) {
        let y = i32(id.y) + i32(k) - i32(params.radius);
        let inside = y >= 0 && y < i32(params.height);
        let at = 5u * u32(clamp(y, 0, i32(params.height) - 1)) * stride + x;
        let w_1 = select(0.0, window[k / 4u][k % 4u], inside);
        let t = (f32(k) - f32(params.radius)) * params.step;
        let w_y = w_1 * t;
        let w_yy = w_y * t;
        let xx = equations[at];
        let xy = equations[at + stride];
        let yy = equations[at + 2u * stride];
        let q_x = equations[at + 3u * stride];
        let q_y = equations[at + 4u * stride];
        one[0] += w_1 * xx;
        one[1] += w_1 * xy;
        one[2] += w_1 * yy;
        one[3] += w_1 * q_x;
        one[4] += w_1 * q_y;
        first[0] += w_y * xx;
        first[1] += w_y * xy;
        first[2] += w_y * yy;
        first[3] += w_y * q_x;
        first[4] += w_y * q_y;
        second[0] += w_yy * xx;
        second[1] += w_yy * xy;
        second[2] += w_yy * yy;
    }
    if id.x < stride && id.y < params.height {
        let at = 13u * id.y * stride + x;
        columns[at] = one[0];
        columns[at + stride] = one[1];
        columns[at + 2u * stride] = one[2];
        columns[at + 3u * stride] = one[3];
        columns[at + 4u * stride] = one[4];
        columns[at + 5u * stride] = first[0];
        columns[at + 6u * stride] = first[1];
        columns[at + 7u * stride] = first[2];
        columns[at + 8u * stride] = first[3];
        columns[at + 9u * stride] = first[4];
        columns[at + 10u * stride] = second[0];
        columns[at + 11u * stride] = second[1];
        columns[at + 12u * stride] = second[2];
    }
}
