//! Every kernel of the registry: naga's checks of its shader, and the comparison of its two sides.

use std::ops::ControlFlow;

use viewsphere::gpu::reflect_variant;
use viewsphere::kernel::{Kernel, Variant};
use viewsphere::kernels;

use crate::need;
use crate::sides;

fn compare_sides(kernel: &Kernel) {
    let Some(gpu) = need::gpu() else { return };
    sides::compare_sides(&gpu, kernel, |sides::Compared { what, difference, as_default }| {
        assert!(difference.breaches == 0, "{what}: {difference:?}");
        // So far variants differ in workgroups only, which does not change any pixel's arithmetic.
        assert!(as_default, "{what}: other bits than the default variant's");
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
fn every_variant_of_every_shader_fits_its_kernel() {
    let problems: Vec<String> = kernels::ALL
        .iter()
        .flat_map(|kernel| kernel.variants.iter().map(move |variant| reflect_variant(kernel, variant)))
        .filter_map(Result::err)
        .map(|error| error.to_string())
        .collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn variants_are_named_once_and_change_the_shader() {
    for kernel in kernels::ALL {
        let shapes: Vec<_> = kernel.variants.iter().map(|v| reflect_variant(kernel, v).unwrap()).collect();
        assert_eq!(kernel.variants[0], Variant::DEFAULT, "{}", kernel.name);
        for (i, variant) in kernel.variants.iter().enumerate() {
            for (j, other) in kernel.variants[..i].iter().enumerate() {
                assert_ne!(variant.name, other.name, "{}", kernel.name);
                assert_ne!(shapes[i], shapes[j], "{}: {} and {}", kernel.name, variant.name, other.name);
            }
        }
    }
}
