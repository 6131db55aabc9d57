
// The weighted least-squares fit of 1, x, y, x², y², xy to a neighbourhood, of four pixels at once.

struct Moments {
    // Σ xⁱ yʲ g c, named by i and j
    m_00: vec4f, m_10: vec4f, m_20: vec4f, m_30: vec4f, m_40: vec4f,
    m_01: vec4f, m_11: vec4f, m_21: vec4f, m_31: vec4f,
    m_02: vec4f, m_12: vec4f, m_22: vec4f,
    m_03: vec4f, m_13: vec4f,
    m_04: vec4f,
    // Σ xⁱ yʲ g c f
    f_00: vec4f, f_10: vec4f, f_20: vec4f,
    f_01: vec4f, f_11: vec4f,
    f_02: vec4f,
}

struct Solution {
    b_x: vec4f,
    b_y: vec4f,
    a_xx: vec4f,
    a_yy: vec4f,
    cross_term: vec4f,
    certainty: vec4f,
}

// Elimination without square roots (LDLᵀ), in the order 1, x, y, p = x², q = y², r = xy. Rounding is not worse for
// coordinates in pixels than for scaled ones: scaling an unknown scales its row, its column and its pivot alike.
fn solve(m: Moments, min_share: f32, least: f32) -> Solution {
    let x1 = m.m_10 / m.m_00;
    let y1 = m.m_01 / m.m_00;
    let p1 = m.m_20 / m.m_00;
    let q1 = m.m_02 / m.m_00;
    let r1 = m.m_11 / m.m_00;
    let xx = m.m_20 - x1 * m.m_10;
    let xy = m.m_11 - y1 * m.m_10;
    let xp = m.m_30 - p1 * m.m_10;
    let xq = m.m_12 - q1 * m.m_10;
    let xr = m.m_21 - r1 * m.m_10;
    let xf = m.f_10 - x1 * m.f_00;

    let yx = xy / xx;
    let px = xp / xx;
    let qx = xq / xx;
    let rx = xr / xx;
    let yy = m.m_02 - y1 * m.m_01 - yx * xy;
    let yp = m.m_21 - p1 * m.m_01 - px * xy;
    let yq = m.m_03 - q1 * m.m_01 - qx * xy;
    let yr = m.m_12 - r1 * m.m_01 - rx * xy;
    let yf = m.f_01 - y1 * m.f_00 - yx * xf;

    let py = yp / yy;
    let qy = yq / yy;
    let ry = yr / yy;
    let pp = m.m_40 - p1 * m.m_20 - px * xp - py * yp;
    let pq = m.m_22 - q1 * m.m_20 - qx * xp - qy * yp;
    let pr = m.m_31 - r1 * m.m_20 - rx * xp - ry * yp;
    let pf = m.f_20 - p1 * m.f_00 - px * xf - py * yf;

    let qp = pq / pp;
    let rp = pr / pp;
    let qq = m.m_04 - q1 * m.m_02 - qx * xq - qy * yq - qp * pq;
    let qr = m.m_13 - r1 * m.m_02 - rx * xq - ry * yq - rp * pq;
    let qf = m.f_02 - q1 * m.f_00 - qx * xf - qy * yf - qp * pf;

    let rq = qr / qq;
    let rr = m.m_22 - r1 * m.m_11 - rx * xr - ry * yr - rp * pr - rq * qr;
    let rf = m.f_11 - r1 * m.f_00 - rx * xf - ry * yf - rp * pf - rq * qf;

    let r = rf / rr;
    let q = qf / qq - rq * r;
    let p = pf / pp - rp * r - qp * q;
    let y = yf / yy - ry * r - qy * q - py * p;
    let x = xf / xx - rx * r - qx * q - px * p - yx * y;

    // A pivot against its diagonal: the share of a term that the terms before it do not explain.
    let share_1 = min(xx / m.m_20, yy / m.m_02);
    let share_2 = min(min(pp / m.m_40, qq / m.m_04), rr / m.m_22);
    // Where a pivot is zero or negative, the ones after it are arbitrary, so each is checked.
    let determined = (m.m_00 > vec4f(least))
        & (xx > min_share * m.m_20) & (yy > min_share * m.m_02)
        & (pp > min_share * m.m_40) & (qq > min_share * m.m_04) & (rr > min_share * m.m_22);
    let fade = min(min(share_1, share_2) / min_share - 1.0, vec4f(1.0));
    let none = vec4f();
    return Solution(
        select(none, x, determined),
        select(none, y, determined),
        select(none, p, determined),
        select(none, q, determined),
        select(none, r, determined),
        select(none, m.m_00 * fade, determined),
    );
}
