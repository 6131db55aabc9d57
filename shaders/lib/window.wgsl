
// Windows that slide along a row in registers, four columns at a time.

// Four neighbouring sums of four weighted columns each.
fn slide(a: vec4f, b: vec4f, w: vec4f) -> vec4f {
    return w.x * a + w.y * vec4f(a.yzw, b.x) + w.z * vec4f(a.zw, b.xy) + w.w * vec4f(a.w, b.xyz);
}

// The columns numbered `four`, clamped to the row of `last` + 1: past its ends the end's value.
fn repeat_ends(clamped: vec4f, four: i32, last: i32) -> vec4f {
    return select(select(clamped, vec4f(clamped.x), four < 0), vec4f(clamped.w), four > last);
}
