
// Rows of five channels, `columns`, averaged by a symmetric window: sixteen columns at a time, the window sliding in
// registers, four new columns a step.

const MAX_STEPS = 258u;

struct Sums {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// The averages of sixteen columns from the given four on.
fn sums(four: u32, y: u32, channel: u32) -> Sums {
    let reach = (params.radius + 3u) / 4u;
    let row = (5u * y + channel) * ((params.width + 3u) / 4u);
    var x = i32(four) - i32(reach);
    var f0 = column(row, x);
    var f1 = column(row, x + 1);
    var f2 = column(row, x + 2);
    var f3 = column(row, x + 3);
    x += 4;
    var s = Sums();
    for (var k = 0u; k < min((4u * reach + params.radius + 4u) / 4u, MAX_STEPS); k++) {
        let f4 = column(row, x);
        let w = window[k];
        s.a += slide(f0, f1, w);
        s.b += slide(f1, f2, w);
        s.c += slide(f2, f3, w);
        s.d += slide(f3, f4, w);
        f0 = f1; f1 = f2; f2 = f3; f3 = f4;
        x++;
    }
    return s;
}

// Four columns; past the ends of the row the end's value.
fn column(row: u32, four: i32) -> vec4f {
    let last = i32((params.width + 3u) / 4u) - 1;
    return repeat_ends(columns[row + u32(clamp(four, 0, last))], four, last);
}
