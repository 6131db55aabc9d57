
// The slopes of the flow at a pixel, in pixels per pixel: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y. They are central differences,
// one-sided at the border, and 0 across an image one pixel wide or high.
fn slopes(x: u32, y: u32) -> vec4f {
    let left = max(x, 1u) - 1u;
    let right = min(x + 1u, params.width - 1u);
    let above = max(y, 1u) - 1u;
    let below = min(y + 1u, params.height - 1u);
    let along_x = select(1.0, 0.5, right - left == 2u) * (displacement(right, y) - displacement(left, y));
    let along_y = select(1.0, 0.5, below - above == 2u) * (displacement(x, below) - displacement(x, above));
    return vec4f(along_x.x, along_y.x, along_x.y, along_y.y);
}

fn displacement(x: u32, y: u32) -> vec2f {
    let stride = (params.width + 3u) / 4u * 4u;
    return vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
}

// The slopes expected at a pixel.
fn expected(x: u32, y: u32) -> vec4f {
    let stride = (params.width + 3u) / 4u * 4u;
    let at = 4u * y * stride + x;
    return vec4f(slope[at], slope[at + stride], slope[at + 2u * stride], slope[at + 3u * stride]);
}
