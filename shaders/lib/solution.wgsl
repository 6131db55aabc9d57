
// The displacements that solve four pixels' equations by Cramer's rule, with `regular` added to the determinant.

struct Solution {
    u: vec4f,
    v: vec4f,
}

fn solution(equations: Five, regular: f32) -> Solution {
    let g_xx = equations.a;
    let g_xy = equations.b;
    let g_yy = equations.c;
    let h_x = equations.d;
    let h_y = equations.e;
    let scale = 1.0 / (g_xx * g_yy - g_xy * g_xy + regular);
    return Solution(known((g_yy * h_x - g_xy * h_y) * scale), known((g_xx * h_y - g_xy * h_x) * scale));
}

// A result without a value, after overflow, becomes zero motion, so that it cannot spread.
fn known(d: vec4f) -> vec4f {
    return select(vec4f(), d, abs(d) <= vec4f(1e9));
}
