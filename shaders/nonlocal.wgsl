// A robust mean of the flow around each pixel, over pixels that look like it and whose flow fits.
// Sun, Roth and Black 2010, section 4.

struct Params {
    width: u32,
    height: u32,
    radius: u32,   // the grid has 2 radius + 1 samples along each axis
    spacing: u32,  // of neighbouring samples, in pixels
    rounds: u32,   // how often the mean is reweighted
    nearness: f32, // −log₂ e / (2 σ²)
    tone: f32,     // inverse square of the difference of gray levels at which a sample counts half
    robust: f32,   // squared difference of displacements up to which the norm is that of squares
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> flow: array<f32>;
@group(0) @binding(2) var<storage, read> slope: array<f32>; // channels: ∂u/∂x, ∂u/∂y, ∂v/∂x, ∂v/∂y
@group(0) @binding(3) var<storage, read> image: array<f32>;
@group(0) @binding(4) var<storage, read> weight: array<f32>;
@group(0) @binding(5) var<storage, read_write> mean: array<f32>;

const SPAN = vec2u(1u, 1u);
const MOST = 49u;
const MOST_ROUNDS = 8u;

@compute @workgroup_size(16, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let x = min(id.x, params.width - 1u);
    let y = min(id.y, params.height - 1u);
    let at = 4u * y * stride + x;
    let along_x = vec2f(slope[at], slope[at + 2u * stride]);
    let along_y = vec2f(slope[at + stride], slope[at + 3u * stride]);
    let gray = image[y * stride + x];
    let side = 2u * params.radius + 1u;
    // Each sample's displacement, carried to the pixel, and its weight.
    var samples: array<vec3f, 49>;
    for (var n = 0u; n < min(side * side, MOST); n++) {
        let i = i32(n % side) - i32(params.radius);
        let j = i32(n / side) - i32(params.radius);
        let away = i32(params.spacing) * vec2i(i, j);
        let place = vec2i(vec2u(x, y)) + away;
        let inside = all(place >= vec2i()) && all(place < vec2i(vec2u(params.width, params.height)));
        let there = vec2u(select(vec2i(vec2u(x, y)), place, inside));
        let d = vec2f(flow[2u * there.y * stride + there.x], flow[(2u * there.y + 1u) * stride + there.x]);
        let off = image[there.y * stride + there.x] - gray;
        let distance = vec2f(away);
        let near = select(power_of_two(params.nearness * dot(distance, distance)), 2.0, i == 0 && j == 0);
        let w = weight[there.y * stride + there.x] * near / (1.0 + off * off * params.tone);
        samples[n] = vec3f(d - (along_x * distance.x + along_y * distance.y), select(0.0, w, inside));
    }
    var d = vec2f(flow[2u * y * stride + x], flow[(2u * y + 1u) * stride + x]);
    for (var round = 0u; round < min(params.rounds, MOST_ROUNDS); round++) {
        var sum = vec3f();
        for (var n = 0u; n < min(side * side, MOST); n++) {
            let s = samples[n];
            let off = s.xy - d;
            let w = s.z / sqrt(dot(off, off) + params.robust);
            sum += w * vec3f(s.xy, 1.0);
        }
        d = sum.xy / sum.z;
    }
    if id.x < stride && id.y < params.height {
        mean[2u * id.y * stride + id.x] = d.x;
        mean[(2u * id.y + 1u) * stride + id.x] = d.y;
    }
}
