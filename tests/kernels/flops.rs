//! The floating-point operations that are counted in shaders, beside counts by hand.

use viewsphere::frame::Size;
use viewsphere::gpu::FlopCounter;
use viewsphere::kernel::Kernel;
use viewsphere::kernels::{ALL, carry, window_y};
use viewsphere::plan::{Bufs, Shape, Step};

fn per_invocation<P: bytemuck::Pod>(kernel: &Kernel, params: P) -> Option<u64> {
    FlopCounter::new(kernel).unwrap().per_invocation(bytemuck::bytes_of(&params))
}

#[test]
fn straight_code_counts_as_by_hand() {
    let params = carry::Params { width: 8, height: 8, sense: -1.0, weight: 0.5, inverse: 25.0 };
    // The place 4, its fraction 2, three mixtures of two components 18, the change 2, its square 3, the weight 3, the result 4.
    assert_eq!(per_invocation(&carry::KERNEL, params), Some(36));
}

#[test]
fn loops_count_as_often_as_their_parameters_say() {
    for radius in [0_u32, 2, 8, 18] {
        let params = window_y::Params { width: 8, height: 8, radius };
        // Eight sums of four columns take four products and four sums a turn.
        let turns = u64::from((2 * radius + 4) / 4);
        assert_eq!(per_invocation(&window_y::KERNEL, params), Some(8 * 4 * 8 * turns), "radius {radius}");
    }
}

#[test]
fn a_step_counts_its_pixels() {
    let case = (carry::KERNEL.cases)(Size::new(65, 33)).swap_remove(0);
    let mut bufs = Bufs::default();
    let [flow, previous, drawn, kept] =
        [2, 3, 2, 3].map(|n| (bufs.computed("image", Shape::planar(case.extent, n)), n));
    let shape = |n: usize| Shape::planar(case.extent, n);
    let params: carry::Params = bytemuck::pod_read_unaligned(&case.params);
    let outputs = [(drawn.0, shape(drawn.1)), (kept.0, shape(kept.1))];
    let step = Step::new(&carry::KERNEL, "", params, &[flow.0, previous.0], &outputs);
    assert_eq!(FlopCounter::new(&carry::KERNEL).unwrap().of_step(&step), Some(36 * 65 * 33));
}

/// Bounds that depend on buffers or on the place in a workgroup cannot be counted, and are not guessed.
#[test]
fn most_kernels_have_a_count() {
    let without: Vec<&str> = ALL
        .iter()
        .filter(|kernel| {
            let case = (kernel.cases)(Size::new(65, 33)).swap_remove(0);
            FlopCounter::new(kernel).unwrap().per_invocation(&case.params).is_none()
        })
        .map(|kernel| kernel.name)
        .collect();
    println!("without a count: {}", without.join(", "));
    assert!(without.contains(&"downsample_flow") && without.len() < ALL.len() / 4, "{without:?}");
}
