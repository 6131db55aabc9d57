// Polynomial expansion by normalised convolution, vertical half: the columns of an image's certainty c, and of the
// image f times its certainty, are summed with the applicability g times powers of y. Farnebäck 2003, section 2, with
// the separable Gaussian applicability of his thesis.

struct Params {
    width: u32,
    height: u32,
    radius: u32,  // of the neighbourhood: 2 radius + 1 rows
    outside: f32, // weight of rows outside the image: 1 repeats the border, 0 leaves them out
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> weighted: array<vec4f>; // c f
@group(0) @binding(2) var<storage, read> certainty: array<vec4f>;
@group(0) @binding(3) var<uniform> applicability: array<vec4f, 1024>; // four samples each of g, y g, y² g, then the next
@group(0) @binding(4) var<storage, read_write> moments: array<vec4f>; // channels: Σ yᵏ g c for k to 4, Σ yᵏ g c f to 2

const SPAN = vec2u(4u, 1u);
const MAX_STEPS = 17u;

@compute @workgroup_size(32, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u;
    let x4 = min(id.x, stride - 1u);
    let first = -i32(params.radius);
    var c0 = vec4f();
    var c1 = vec4f();
    var c2 = vec4f();
    var c3 = vec4f();
    var c4 = vec4f();
    var f0 = vec4f();
    var f1 = vec4f();
    var f2 = vec4f();
    for (var k = 0u; k < min((2u * params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let begin = first + 4 * i32(k);
        let y = vec4f(f32(begin)) + vec4f(0.0, 1.0, 2.0, 3.0);
        let rows = vec4i(i32(id.y) + begin) + vec4i(0, 1, 2, 3);
        let inside = rows >= vec4i(0) & rows < vec4i(i32(params.height));
        let weight = select(vec4f(params.outside), vec4f(1.0), inside);
        let g = weight * applicability[3u * k];
        let yg = weight * applicability[3u * k + 1u];
        let yyg = weight * applicability[3u * k + 2u];
        let at = vec4u(
            row(x4, rows.x),
            row(x4, rows.y),
            row(x4, rows.z),
            row(x4, rows.w),
        );
        let c = mat4x4f(certainty[at.x], certainty[at.y], certainty[at.z], certainty[at.w]);
        let f = mat4x4f(weighted[at.x], weighted[at.y], weighted[at.z], weighted[at.w]);
        c0 += c * g;
        c1 += c * yg;
        c2 += c * yyg;
        c3 += c * (yyg * y);
        c4 += c * (yyg * y * y);
        f0 += f * g;
        f1 += f * yg;
        f2 += f * yyg;
    }
    if id.x < stride && id.y < params.height {
        let at = 8u * id.y * stride + id.x;
        moments[at] = c0;
        moments[at + stride] = c1;
        moments[at + 2u * stride] = c2;
        moments[at + 3u * stride] = c3;
        moments[at + 4u * stride] = c4;
        moments[at + 5u * stride] = f0;
        moments[at + 6u * stride] = f1;
        moments[at + 7u * stride] = f2;
    }
}

// Where the four pixels numbered x4 of row y begin.
fn row(x4: u32, y: i32) -> u32 {
    return clamp_index(y, params.height) * ((params.width + 3u) / 4u) + x4;
}
