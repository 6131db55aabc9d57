// The linear equations that smoothness makes of each pixel's own and its four neighbours': what sweep.wgsl solves.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> equations: array<f32>; // channels: G_xx, G_xy, G_yy, q_x, q_y
@group(0) @binding(2) var<storage, read> flow: array<f32>;
@group(0) @binding(3) var<storage, read> smooth_weight: array<f32>;
@group(0) @binding(4) var<storage, read> slope: array<f32>; // channels: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y
@group(0) @binding(5) var<storage, read_write> system: array<f32>; // channels: (G + S)⁻¹ xx, xy, yy, and c_x, c_y
@group(0) @binding(6) var<storage, read_write> link: array<f32>; // channels: to the right, down

const SPAN = vec2u(1u, 1u);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let before = max(x, 1u) - 1u;
    let next = min(x + 1u, params.width - 1u);
    let above = max(y, 1u) - 1u;
    let below = min(y + 1u, params.height - 1u);
    let own = smooth_weight[y * stride + x];
    let left = select(0.0, 0.5 * (own + smooth_weight[y * stride + before]), x > 0u);
    let right = select(0.0, 0.5 * (own + smooth_weight[y * stride + next]), x + 1u < params.width);
    let up = select(0.0, 0.5 * (own + smooth_weight[above * stride + x]), y > 0u);
    let down = select(0.0, 0.5 * (own + smooth_weight[below * stride + x]), y + 1u < params.height);
    let along_x = slope_along(0u, x, y);
    let along_y = slope_along(1u, x, y);
    let horizontal = left * (along_x + slope_along(0u, before, y)) - right * (along_x + slope_along(0u, next, y));
    let vertical = up * (along_y + slope_along(1u, x, above)) - down * (along_y + slope_along(1u, x, below));
    let at = 5u * y * stride + x;
    let g = vec3f(equations[at], equations[at + stride], equations[at + 2u * stride]);
    let q = vec2f(equations[at + 3u * stride], equations[at + 4u * stride]);
    let d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    let c = vec2f(dot(g.xy, d), dot(g.yz, d)) + q + 0.5 * (horizontal + vertical);
    let sum = right + left + down + up + 1e-9;
    let a = g.x + sum;
    let b = g.z + sum;
    let inverse = 1.0 / (a * b - g.y * g.y);
    if id.x < stride && id.y < params.height {
        let at = 5u * id.y * stride + id.x;
        system[at] = b * inverse;
        system[at + stride] = -g.y * inverse;
        system[at + 2u * stride] = a * inverse;
        system[at + 3u * stride] = c.x;
        system[at + 4u * stride] = c.y;
        link[2u * id.y * stride + id.x] = right;
        link[(2u * id.y + 1u) * stride + id.x] = down;
    }
}

// The expected slopes of u and of v along x (0) or y (1).
fn slope_along(axis: u32, x: u32, y: u32) -> vec2f {
    let stride = (params.width + 3u) / 4u * 4u;
    let at = (4u * y + axis) * stride + x;
    return vec2f(slope[at], slope[at + 2u * stride]);
}
