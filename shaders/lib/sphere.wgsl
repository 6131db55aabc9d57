
// Bearings on the view sphere. A ray is (x, y, 1) of the ideal pinhole.

struct MidpointFlow {
    midpoint: vec3f, // unit bearing half-way
    flow: vec3f,     // tangent there, in radians
}

// The motion along the arc from ray b, where a point was, to ray a, where it is now. difference is a − b, so that a
// small arc keeps all its digits.
fn midpoint_flow(a: vec3f, b: vec3f, difference: vec3f) -> MidpointFlow {
    let length_a = length(a);
    let length_b = length(b);
    let shorter = dot(difference, a + b) / (length_a + length_b);
    let chord = (difference * length_b - b * shorter) / (length_a * length_b);
    let sum = a / length_a + b / length_b;
    // The ratio of the arc to its chord: asin(z) / z at half the chord.
    let z = 0.25 * dot(chord, chord);
    let arc = 1.0 + z * (1.0 / 6.0 + z * (3.0 / 40.0 + z * (15.0 / 336.0 + z * (105.0 / 3456.0))));
    return MidpointFlow(sum / max(length(sum), 1e-20), chord * arc);
}
