//! Shared by the kernels on the view sphere: rays, and the arc between two of them.

/// The rows of `prev_from_cur − 1`, then the direction of motion and its standard error: the `motion` buffer.
#[inline(always)]
pub(super) fn rows(motion: &[f32]) -> [[f32; 4]; 4] {
    std::array::from_fn(|row| std::array::from_fn(|i| motion[4 * row + i]))
}

#[inline(always)]
pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A ray of the current camera in the previous camera's frame.
#[inline(always)]
pub(super) fn turned(motion: &[[f32; 4]; 4], r: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| r[i] + dot([motion[i][0], motion[i][1], motion[i][2]], r))
}

/// A ray of the previous camera in the current camera's frame, minus the ray.
#[inline(always)]
pub(super) fn turn_back(motion: &[[f32; 4]; 4], r: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| r[0] * motion[0][i] + r[1] * motion[1][i] + r[2] * motion[2][i])
}

/// An ideal pinhole: focal lengths and principal point, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Pinhole {
    pub(super) focal: [f32; 2],
    pub(super) centre: [f32; 2],
}

/// The bearing of a point half-way between two frames, and its motion.
pub(super) struct MidpointFlow {
    /// A unit bearing.
    pub(super) midpoint: [f32; 3],
    /// The motion, a tangent at the bearing, in radians.
    pub(super) flow: [f32; 3],
}

impl Pinhole {
    /// The midpoint flow of pixel (`x`, `y`), which was displaced by `d` pixels in the previous frame; no motion if `d`
    /// is unknown.
    #[inline(always)]
    pub(super) fn midpoint_flow(
        self,
        motion: &[[f32; 4]; 4],
        [x, y]: [f32; 2],
        d: [f32; 2],
    ) -> (MidpointFlow, bool) {
        let known = d[0] * d[0] + d[1] * d[1] <= 1e12;
        let d = if known { d } else { [0.0; 2] };
        let current = [(x - self.centre[0]) / self.focal[0], (y - self.centre[1]) / self.focal[1], 1.0];
        let shift = [d[0] / self.focal[0], d[1] / self.focal[1], 0.0];
        let unturned = std::array::from_fn(|i| current[i] + shift[i]);
        let turned = turn_back(motion, unturned);
        let previous = std::array::from_fn(|i| unturned[i] + turned[i]);
        let difference = std::array::from_fn(|i| -shift[i] - turned[i]);
        (midpoint_flow(current, previous, difference), known)
    }

    /// The displacement from pixel (`x`, `y`) to the place at which the previous camera showed the same direction.
    #[inline(always)]
    pub(super) fn turn(self, motion: &[[f32; 4]; 4], [x, y]: [f32; 2]) -> [f32; 2] {
        let current = [(x - self.centre[0]) / self.focal[0], (y - self.centre[1]) / self.focal[1], 1.0];
        let moved: [f32; 3] =
            std::array::from_fn(|i| dot([motion[i][0], motion[i][1], motion[i][2]], current));
        let z = 1.0 + moved[2];
        // In this form no two large numbers are subtracted.
        let shift = |i: usize| self.focal[i] * (moved[i] - current[i] * moved[2]) / z;
        if z > 0.01 { [shift(0), shift(1)] } else { [0.0; 2] }
    }
}

/// The motion along the arc from ray `b`, where a point was, to ray `a`, where it is now. `difference` is a − b, so
/// that a small arc keeps all its digits: the chord is `((a − b) |b| − b (|a| − |b|)) / (|a| |b|)`.
#[inline(always)]
fn midpoint_flow(a: [f32; 3], b: [f32; 3], difference: [f32; 3]) -> MidpointFlow {
    let (length_a, length_b) = (dot(a, a).sqrt(), dot(b, b).sqrt());
    let sum = std::array::from_fn(|i| a[i] + b[i]);
    let shorter = dot(difference, sum) / (length_a + length_b);
    let scale = 1.0 / (length_a * length_b);
    let chord: [f32; 3] = std::array::from_fn(|i| (difference[i] * length_b - b[i] * shorter) * scale);
    let sum: [f32; 3] = std::array::from_fn(|i| a[i] / length_a + b[i] / length_b);
    let length = dot(sum, sum).sqrt().max(1e-20);
    // The ratio of the arc to its chord: asin(z) / z at half the chord.
    let z = 0.25 * dot(chord, chord);
    let arc = 1.0 + z * (1.0 / 6.0 + z * (3.0 / 40.0 + z * (15.0 / 336.0 + z * (105.0 / 3456.0))));
    MidpointFlow { midpoint: sum.map(|v| v / length), flow: chord.map(|v| v * arc) }
}
