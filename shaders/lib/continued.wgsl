
// The second frame's expansion, sampled as by second_at, with each of the four slopes continued to the place by the share
// `kappa` of its own Hessian.
fn continued_second_at(place: vec2f, kappa: f32) -> Second {
    var second = second_at(place);
    let stride = (params.width + 3u) / 4u * 4u;
    let whole = floor(place);
    let at = vec2u(select(vec2f(), whole, second.inside));
    let i = at.y * stride + at.x;
    let right = select(0u, 1u, second.inside);
    let below = select(0u, stride, second.inside);
    let f = place - whole;
    let g = f - 1.0;
    let a = (1.0 - f.x) * (1.0 - f.y) * hessian(i);
    let b = f.x * (1.0 - f.y) * hessian(i + right);
    let c = (1.0 - f.x) * f.y * hessian(i + below);
    let d = f.x * f.y * hessian(i + below + right);
    let along_x = (a.x + c.x) * f.x + (b.x + d.x) * g.x + (a.y + b.y) * f.y + (c.y + d.y) * g.y;
    let along_y = (a.z + b.z) * f.y + (c.z + d.z) * g.y + (a.y + c.y) * f.x + (b.y + d.y) * g.x;
    second.expansion.quad += vec4f(kappa * vec2f(along_x, along_y), 0.0, 0.0);
    return second;
}

// A pixel's Hessian in the second frame: xx, xy, yy.
fn hessian(i: u32) -> vec3f {
    return vec3f(2.0 * quad_1[i].z, cross_term_1[i], 2.0 * quad_1[i].w);
}
