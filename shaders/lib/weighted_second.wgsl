
// The second frame's expansion, sampled by normalised interpolation: with each of the four pixels around the place weighted by
// its certainty too, so that pixels without an expansion do not draw the mean towards zero, and continued to the place by the
// share `kappa` of its own Hessian. The kernel says where the cross term and the certainty of a pixel are, in `cross_term_of`
// and `certainty_of`.
struct WeightedSecond {
    second: Second,
    certainty: f32,
}

fn weighted_second_at(place: vec2f, kappa: f32) -> WeightedSecond {
    let stride = (params.width + 3u) / 4u * 4u;
    let whole = floor(place);
    // NaN is not inside either.
    let inside = all(whole >= vec2f()) && all(whole < vec2f(f32(params.width), f32(params.height)) - 1.0);
    let at = vec2u(select(vec2f(), whole, inside));
    let i = at.y * stride + at.x;
    // One past the end only where an image is one pixel wide or high, and then no place is inside.
    let right = select(0u, 1u, inside);
    let below = select(0u, stride, inside);
    let f = place - whole;
    let a = weighted(i, (1.0 - f.x) * (1.0 - f.y), f, kappa);
    let b = weighted(i + right, f.x * (1.0 - f.y), f - vec2f(1.0, 0.0), kappa);
    let c = weighted(i + below, (1.0 - f.x) * f.y, f - vec2f(0.0, 1.0), kappa);
    let d = weighted(i + below + right, f.x * f.y, f - 1.0, kappa);
    let sum = a.certainty + b.certainty + c.certainty + d.certainty;
    let expansion = Expansion(
        (a.expansion.quad + b.expansion.quad + c.expansion.quad + d.expansion.quad) / sum,
        (a.expansion.cross_term + b.expansion.cross_term + c.expansion.cross_term + d.expansion.cross_term) / sum,
    );
    return WeightedSecond(Second(expansion, inside), sum);
}

// One of the four pixels around a place, times its weight and its certainty.
struct Weighted {
    expansion: Expansion,
    certainty: f32,
}

fn weighted(i: u32, weight: f32, away: vec2f, kappa: f32) -> Weighted {
    let w = weight * certainty_of(i);
    let quad = quad_1[i];
    let cross_term = cross_term_of(i);
    let slope = vec2f(2.0 * quad.z * away.x + cross_term * away.y, cross_term * away.x + 2.0 * quad.w * away.y);
    return Weighted(Expansion(w * (quad + vec4f(kappa * slope, 0.0, 0.0)), w * cross_term), w);
}
