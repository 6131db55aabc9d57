//! The bound of the kernel that follows points: it promises something nearly everywhere, and leaves little room.

use viewsphere::frame::Size;
use viewsphere::kernels::compare::POISON;
use viewsphere::kernels::track_points;

/// The bounds of the places of followed points in a case, px, and the number of values without a bound.
fn bounds(name: &str) -> (Vec<f32>, usize) {
    let kernel = &track_points::KERNEL;
    let cases = (kernel.cases)(Size::new(641, 363));
    let case = cases.iter().find(|case| case.name == name).unwrap();
    let inputs: Vec<&[f32]> = case.inputs.iter().map(Vec::as_slice).collect();
    let mut tracked = vec![POISON; case.outputs[0]];
    (kernel.reference)(&case.params, &inputs, &mut [tracked.as_mut_slice()]);
    let bounds = kernel.bounds(&case.params, &inputs, &[&tracked]);
    let points = bounds[0].own.as_chunks::<4>().0;
    let open = points.iter().filter(|point| point[0] == f32::MAX).count();
    // Points that are absent or lost at once keep their place.
    let moved = points.iter().filter(|point| point[0] > 0.0 && point[0] < f32::MAX);
    (moved.flat_map(|point| [point[0], point[1]]).collect(), open)
}

#[test]
fn the_bound_of_followed_points_is_tight() {
    // After up to ten iterations on a smooth texture, and after three that do not converge.
    for (name, most) in [("a texture that moves", 1e-3), ("one step", 1e-3), ("random images", 1e-2)] {
        let (places, open) = bounds(name);
        let widest = places.iter().copied().fold(0.0, f32::max);
        println!("{name}: {} bounds, at most {widest:.1e} px, {open} points without one", places.len());
        assert!(places.len() >= 40 && widest <= most && open <= 3, "{name}: {widest:e}, {open}");
    }
}
