// Averages columns of five channels by a symmetric window: the vertical half of the neighbourhood's sum.

struct Params {
    width: u32,
    height: u32,
    radius: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> equations: array<vec4f>;
@group(0) @binding(2) var<uniform> window: array<vec4f, 1024>; // weights from −radius to radius, then zeros
@group(0) @binding(3) var<storage, read_write> columns: array<vec4f>;

// Eight rows at a time: the window of rows slides in registers, four new rows per step. A row's channels lie side by
// side and are averaged alike, so that they are one row here: neighbouring invocations read adjacent memory.
const SPAN = vec2u(4u, 8u);
const SIDE_BY_SIDE = 5u;
const MAX_STEPS = 257u;

override WORKGROUP_X = 32u;
override WORKGROUP_Y = 1u;

@compute @workgroup_size(WORKGROUP_X, WORKGROUP_Y)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let row = i32(SIDE_BY_SIDE * ((params.width + 3u) / 4u));
    let x4 = i32(id.x);
    let first = min(x4, row - 1);
    let last = first + i32(params.height - 1u) * row;
    let start = first + i32(id.y * SPAN.y) * row;
    var at = start - i32(params.radius) * row;
    var f0 = four(at, first, last);
    var f1 = four(at + row, first, last);
    var f2 = four(at + 2 * row, first, last);
    var f3 = four(at + 3 * row, first, last);
    var f4 = four(at + 4 * row, first, last);
    var f5 = four(at + 5 * row, first, last);
    var f6 = four(at + 6 * row, first, last);
    var f7 = four(at + 7 * row, first, last);
    at += 8 * row;
    var s0 = vec4f(); var s1 = vec4f(); var s2 = vec4f(); var s3 = vec4f();
    var s4 = vec4f(); var s5 = vec4f(); var s6 = vec4f(); var s7 = vec4f();
    // The surplus of the last workgroup takes no step. (That the number of steps depends on the invocation also keeps
    // lavapipe from compiling the kernel anew for every radius it meets, which it would do dispatch by dispatch.)
    let inside = x4 < row;
    let steps = select(0u, (2u * params.radius + 4u) / 4u, inside);
    for (var k = 0u; k < min(steps, MAX_STEPS); k++) {
        let f8 = four(at, first, last);
        let f9 = four(at + row, first, last);
        let f10 = four(at + 2 * row, first, last);
        let f11 = four(at + 3 * row, first, last);
        let w = window[k];
        s0 += w.x * f0 + w.y * f1 + w.z * f2 + w.w * f3;
        s1 += w.x * f1 + w.y * f2 + w.z * f3 + w.w * f4;
        s2 += w.x * f2 + w.y * f3 + w.z * f4 + w.w * f5;
        s3 += w.x * f3 + w.y * f4 + w.z * f5 + w.w * f6;
        s4 += w.x * f4 + w.y * f5 + w.z * f6 + w.w * f7;
        s5 += w.x * f5 + w.y * f6 + w.z * f7 + w.w * f8;
        s6 += w.x * f6 + w.y * f7 + w.z * f8 + w.w * f9;
        s7 += w.x * f7 + w.y * f8 + w.z * f9 + w.w * f10;
        f0 = f4; f1 = f5; f2 = f6; f3 = f7; f4 = f8; f5 = f9; f6 = f10; f7 = f11;
        at += 4 * row;
    }
    let end = select(-1, last, inside);
    store(start, end, s0);
    store(start + row, end, s1);
    store(start + 2 * row, end, s2);
    store(start + 3 * row, end, s3);
    store(start + 4 * row, end, s4);
    store(start + 5 * row, end, s5);
    store(start + 6 * row, end, s6);
    store(start + 7 * row, end, s7);
}

// Past the first and the last row their values.
fn four(at: i32, first: i32, last: i32) -> vec4f {
    return equations[clamp(at, first, last)];
}

fn store(at: i32, end: i32, sum: vec4f) {
    if at <= end {
        columns[at] = sum;
    }
}
