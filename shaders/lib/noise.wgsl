
// The unbounded texture of the simulator: octaves of random values on grids, smoothed by a cubic B-spline.

const OCTAVES = 11u;
const FULL_LOG2 = 1.5;
const AMPLITUDE = 50.0;

// `place` is in metres beyond `cells`, which counts grid spacings of the coarsest octave; along u in turns if there is
// a period. A pixel covers a length whose logarithm to base 2 is `footprint`.
fn textured(place: vec2f, cells: vec2i, period: f32, seed: u32, footprint: f32) -> f32 {
    var sum = 128.0;
    let around = period > 0.0;
    for (var octave = 0u; octave < OCTAVES; octave++) {
        let share = clamp(2.0 - f32(octave) - footprint - FULL_LOG2 + 1.0, 0.0, 1.0);
        if !(share > 0.0) {
            break;
        }
        let per_metre = 0.25 * f32(1u << octave);
        // A period contains a whole number of grid points.
        let points = max(floor(period * per_metre + 0.5), 1.0);
        let turn = select(0.0, 1.0 / points, around);
        let at = place * vec2f(select(per_metre, points, around), per_metre);
        let before = floor(at);
        let x = spline(at.x - before.x);
        let y = spline(at.y - before.y);
        let steps = before.x + vec4f(-1.0, 0.0, 1.0, 2.0);
        let wrapped = steps - points * floor((steps + 0.5) * turn);
        let base = cells << vec2u(octave);
        let columns = bitcast<vec4u>(vec4i(wrapped) + vec4i(base.x));
        let row = i32(before.y) + base.y;
        let octave_seed = scrambled_one(seed ^ scrambled_one(octave));
        let rows = scrambled(vec4u(octave_seed) ^ bitcast<vec4u>(vec4i(row) + vec4i(-1, 0, 1, 2)));
        let value = y.x * dot(x, random(rows.x, columns)) + y.y * dot(x, random(rows.y, columns))
            + y.z * dot(x, random(rows.z, columns)) + y.w * dot(x, random(rows.w, columns));
        sum += AMPLITUDE * (share * share * (3.0 - 2.0 * share)) * (value / 8388608.0 - 1.0);
    }
    return sum;
}

// From 0 to below 2²⁴.
fn random(row: u32, columns: vec4u) -> vec4f {
    return vec4f(vec4i(scrambled(vec4u(row) ^ columns) >> vec4u(8u)));
}

// The weights of the four grid points around a place.
fn spline(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, (3.0 * t - 6.0) * t * t + 4.0, (3.0 * s - 6.0) * s * s + 4.0, t * t * t) * (1.0 / 6.0);
}

// log₂ by the series of the area tangent, to 1e-7: WGSL's own may be off by more.
fn log2_of(value: f32) -> f32 {
    let bits = bitcast<u32>(value);
    let shifted = bits + (0x3f800000u - 0x3f3504f3u);
    let exponent = i32(shifted >> 23u) - 127;
    let mantissa = bitcast<f32>((shifted & 0x007fffffu) + 0x3f3504f3u);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let q = s * s;
    return f32(exponent) + s * (2.8853901 + q * (0.96179669 + q * (0.57707802 + q * 0.41219859)));
}
