
// Sums over the 64 invocations of a workgroup, always in the same order: eight sums of eight, then their sum.

var<workgroup> lanes: array<vec4f, 64>;
var<workgroup> eighths: array<vec4f, 8>;
var<workgroup> total: vec4f;

// The sum of the values of all invocations; all of them must call it.
fn lane_sum(lane: u32, value: vec4f) -> vec4f {
    lanes[lane] = value;
    workgroupBarrier();
    if lane < 8u {
        var sum = vec4f();
        for (var i = 0u; i < 8u; i++) {
            sum += lanes[8u * lane + i];
        }
        eighths[lane] = sum;
    }
    workgroupBarrier();
    if lane == 0u {
        var sum = vec4f();
        for (var i = 0u; i < 8u; i++) {
            sum += eighths[i];
        }
        total = sum;
    }
    return workgroupUniformLoad(&total);
}
