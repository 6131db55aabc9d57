
// Brown–Conrady lenses with a rational radial part: where the lens puts what an ideal pinhole sees at (x, y).
// lens_a holds k1 k2 p1 p2, lens_b k3 k4 k5 k6.

fn distort(ideal: vec2f) -> vec2f {
    let a = params.lens_a;
    let b = params.lens_b;
    let r2 = dot(ideal, ideal);
    let q = (1.0 + r2 * (a.x + r2 * (a.y + r2 * b.x))) / (1.0 + r2 * (b.y + r2 * (b.z + r2 * b.w)));
    let xy = 2.0 * ideal.x * ideal.y;
    let squares = r2 + 2.0 * ideal * ideal;
    return q * ideal + vec2f(a.z * xy + a.w * squares.x, a.z * squares.y + a.w * xy);
}
