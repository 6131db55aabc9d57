
// 2 to the power of x, for x from −126 to 0, as the reference computes it.
fn power_of_two(exponent: f32) -> f32 {
    let x = max(exponent, -126.0);
    let whole = floor(x);
    let f = x - whole;
    let p = 1.0 + f * (0.69314704 + f * (0.2402293 + f
        * (0.05548528 + f * (0.009675456 + f * (0.0012467801 + f * 0.0002161309)))));
    return p * bitcast<f32>(u32(i32(whole) + 127) << 23u);
}
