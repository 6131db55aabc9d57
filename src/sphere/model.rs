//! The model of flow on the view sphere in `f64`: the motion of bearings of a static world while the camera moves.

use glam::DVec3;

/// The rate of a unit bearing p of a static point, in 1/s: `ṗ = −ρ (v − p pᵀv) + p × ω`.
///
/// `nearness_1_m` is ρ, the inverse of the point's distance; `v_m_s` and `omega_rad_s` are the camera's velocity and
/// angular rate relative to the world. All vectors are in the camera's frame.
pub fn bearing_rate(p: DVec3, nearness_1_m: f64, v_m_s: DVec3, omega_rad_s: DVec3) -> DVec3 {
    -nearness_1_m * (v_m_s - p * p.dot(v_m_s)) + p.cross(omega_rad_s)
}

/// The divergence of the translational flow on the unit sphere at a bearing p, in 1/s: `2ρ v·p − v·∇ρ`.
///
/// `gradient_1_m` is ∇ρ, the surface gradient of the nearness over the sphere.
pub fn divergence(p: DVec3, nearness_1_m: f64, gradient_1_m: DVec3, v_m_s: DVec3) -> f64 {
    2.0 * nearness_1_m * v_m_s.dot(p) - v_m_s.dot(gradient_1_m)
}

/// The flow that takes one unit bearing to another: a unit midpoint m, and the tangent there that has the direction of
/// their chord and the length of the arc between them, in radians.
///
/// Divided by the elapsed time, it is the rate at mid-time to second order. Opposite bearings have no midpoint: the
/// result is NaN.
pub fn midpoint_flow(earlier: DVec3, later: DVec3) -> (DVec3, DVec3) {
    let chord = later - earlier;
    let arc = earlier.cross(later).length().atan2(earlier.dot(later));
    let stretch = if arc < 1e-4 { 1.0 + arc * arc / 24.0 } else { arc / (2.0 * (0.5 * arc).sin()) };
    ((earlier + later).normalize(), chord * stretch)
}

/// The rate of a bearing p, from the rates (ẋ, ẏ) of its place (x, y) in the plane at unit distance: `ṗ = ((ẋ, ẏ, 0) −
/// p (p_x ẋ + p_y ẏ)) / √(1 + x² + y²)`.
pub fn from_plane(place: [f64; 2], rate: [f64; 2]) -> DVec3 {
    let ray = DVec3::new(place[0], place[1], 1.0);
    let (p, rate) = (ray.normalize(), DVec3::new(rate[0], rate[1], 0.0));
    (rate - p * p.dot(rate)) / ray.length()
}

/// The rates (ẋ, ẏ) of a bearing's place in the plane at unit distance, from the bearing's rate.
pub fn to_plane(p: DVec3, rate: DVec3) -> [f64; 2] {
    [(rate.x - p.x / p.z * rate.z) / p.z, (rate.y - p.y / p.z * rate.z) / p.z]
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    const V: DVec3 = DVec3::new(2.0, -1.0, 11.0);
    const OMEGA: DVec3 = DVec3::new(0.4, -0.9, 1.3);

    /// Bearings up to 75 degrees off the axis, all around it.
    fn bearings() -> impl Iterator<Item = DVec3> {
        (0..=15).flat_map(|i| {
            (0..12).map(move |j| {
                let (off, around) = (f64::from(5 * i).to_radians(), f64::from(30 * j).to_radians());
                DVec3::new(off.sin() * around.cos(), off.sin() * around.sin(), off.cos())
            })
        })
    }

    /// The bearing of a point after a time, with constant velocity and angular rate of the camera.
    fn seen(point: DVec3, time_s: f64) -> DVec3 {
        let turn = DMat3::from_axis_angle(OMEGA.normalize(), OMEGA.length() * time_s);
        // V is the velocity in the frame at time 0. Over so short a time its change does not matter.
        (turn.transpose() * (point - V * time_s)).normalize()
    }

    #[test]
    fn the_rate_is_that_of_a_moving_point() {
        let step = 1e-5;
        for p in bearings() {
            let point = p * 23.0;
            let differences = (seen(point, step) - seen(point, -step)) / (2.0 * step);
            let rate = bearing_rate(p, 1.0 / 23.0, V, OMEGA);
            assert!((rate - differences).length() <= 1e-6 * rate.length(), "{rate} {differences} at {p}");
        }
    }

    #[test]
    fn the_midpoint_is_of_second_order() {
        let point = DVec3::new(3.0, -2.0, 9.0);
        let error = |interval_s: f64| {
            let (before, after) = (seen(point, -0.5 * interval_s), seen(point, 0.5 * interval_s));
            let (m, flow) = midpoint_flow(before, after);
            assert!(m.dot(flow).abs() < 1e-15);
            (flow / interval_s - bearing_rate(point.normalize(), point.length().recip(), V, OMEGA)).length()
        };
        let (long, short) = (error(0.1), error(0.05));
        assert!((3.0..5.0).contains(&(long / short)), "{long} {short}");
    }

    #[test]
    fn plane_and_sphere_are_two_views_of_one_motion() {
        for p in bearings() {
            let rate = bearing_rate(p, 0.1, V, OMEGA);
            let place = [p.x / p.z, p.y / p.z];
            let back = from_plane(place, to_plane(p, rate));
            assert!((back - rate).length() <= 1e-13 * (1.0 + rate.length()), "{back} {rate}");
        }
    }

    #[test]
    fn the_divergence_is_that_of_finite_differences() {
        // A plane in front: ρ = n·p / d.
        let (normal, distance) = (DVec3::new(0.3, 0.2, 0.9).normalize(), 14.0);
        let nearness = |p: DVec3| normal.dot(p) / distance;
        let field = |p: DVec3| bearing_rate(p, nearness(p), V, DVec3::ZERO);
        for p in bearings() {
            let right = p.any_orthonormal_vector();
            let up = p.cross(right);
            let step = 1e-5;
            let along = |axis: DVec3| {
                let at = |side: f64| field((p + side * step * axis).normalize());
                (at(1.0) - at(-1.0)).dot(axis) / (2.0 * step)
            };
            let gradient = (normal - p * normal.dot(p)) / distance;
            let found = divergence(p, nearness(p), gradient, V);
            assert!((found - along(right) - along(up)).abs() < 1e-7, "{found} at {p}");
            let closed = (3.0 * normal.dot(p) * V.dot(p) - normal.dot(V)) / distance;
            assert!((found - closed).abs() < 1e-12, "{found} {closed}");
        }
    }
}
