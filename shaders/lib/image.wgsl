
// Images: rows of vec4f, four pixels each; the surplus of the last one repeats the row's last pixel.

// v, of the four pixels from x0 on, with everything past the last column replaced by the last column's value.
fn repeat_last(v: vec4f, x0: u32, width: u32) -> vec4f {
    let last = min(width - 1u - min(x0, width - 1u), 3u);
    let edge = select(select(v.x, v.y, last == 1u), select(v.z, v.w, last == 3u), last >= 2u);
    return select(v, vec4f(edge), vec4u(0u, 1u, 2u, 3u) > vec4u(last));
}

// Index i of a row of n samples mirrored at its ends, the end samples not repeated: … 2 1 | 0 1 2 … n−1 | n−2 …
fn reflect_101(i: i32, n: i32) -> u32 {
    let period = max(2 * (n - 1), 1);
    // The remainder by way of f32: its quotient is off by one at most, and no processor divides whole numbers by the
    // vector.
    let rest = abs(i) - i32(f32(abs(i)) / f32(period)) * period;
    let j = select(select(rest, rest - period, rest >= period), rest + period, rest < 0);
    return u32(select(min(j, period - j), 0, n == 1));
}

// Index i clamped to a row of n samples.
fn clamp_index(i: i32, n: u32) -> u32 {
    return u32(clamp(i, 0, i32(n) - 1));
}
