
// Rows of five channels, `columns`, averaged by a symmetric window: sixteen columns at a time, the window sliding in
// registers, four new columns per step.

const MAX_STEPS = 258u;

// Four columns of each channel.
struct Five {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
    e: vec4f,
}

struct Averages {
    four_0: Five,
    four_1: Five,
    four_2: Five,
    four_3: Five,
}

// The averages of sixteen columns from the given four on.
fn averages(four: u32, y: u32) -> Averages {
    let reach = (params.radius + 3u) / 4u;
    var x = i32(four) - i32(reach);
    var f0 = five(x, y);
    var f1 = five(x + 1, y);
    var f2 = five(x + 2, y);
    var f3 = five(x + 3, y);
    x += 4;
    var s = Averages();
    for (var k = 0u; k < min((4u * reach + params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let f4 = five(x, y);
        let w = window[k];
        s.four_0 = add(s.four_0, f0, f1, w);
        s.four_1 = add(s.four_1, f1, f2, w);
        s.four_2 = add(s.four_2, f2, f3, w);
        s.four_3 = add(s.four_3, f3, f4, w);
        f0 = f1; f1 = f2; f2 = f3; f3 = f4;
        x++;
    }
    return s;
}

fn add(s: Five, f0: Five, f1: Five, w: vec4f) -> Five {
    return Five(
        s.a + slide(f0.a, f1.a, w),
        s.b + slide(f0.b, f1.b, w),
        s.c + slide(f0.c, f1.c, w),
        s.d + slide(f0.d, f1.d, w),
        s.e + slide(f0.e, f1.e, w),
    );
}

// Four columns; beyond the ends of the row the end's value.
fn five(four: i32, y: u32) -> Five {
    let stride = (params.width + 3u) / 4u;
    let last = i32(stride) - 1;
    let at = 5u * y * stride + u32(clamp(four, 0, last));
    return Five(
        repeat_ends(columns[at], four, last),
        repeat_ends(columns[at + stride], four, last),
        repeat_ends(columns[at + 2u * stride], four, last),
        repeat_ends(columns[at + 3u * stride], four, last),
        repeat_ends(columns[at + 4u * stride], four, last),
    );
}
