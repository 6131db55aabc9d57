//! Every kernel of the registry: its shader against naga's checks, and its two sides against each other.

use std::ops::ControlFlow;

use viewsphere::gpu::reflect;
use viewsphere::kernel::Kernel;
use viewsphere::kernels;

use crate::need;
use crate::sides;

fn compare_sides(kernel: &Kernel) {
    let Some(gpu) = need::gpu() else { return };
    sides::compare_sides(&gpu, kernel, |sides::Compared { what, difference }| {
        assert!(difference.breaches == 0, "{what}: {difference:?}");
        println!("{what}: max {:e}", difference.max);
        ControlFlow::Continue(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
}

macro_rules! tests {
    ($($kernel:ident),*) => {
        mod both_sides_agree {
            $(#[test] fn $kernel() { super::compare_sides(&viewsphere::kernels::$kernel::KERNEL); })*
        }
    };
}
viewsphere::for_each_kernel!(tests);

#[test]
fn every_shader_fits_its_kernel() {
    let problems: Vec<String> = kernels::ALL
        .iter()
        .filter_map(|kernel| reflect(kernel).err())
        .map(|error| error.to_string())
        .collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
