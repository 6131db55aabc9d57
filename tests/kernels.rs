//! Every kernel of the registry: its shader against naga's checks, and its two sides against each other.

mod common;

use viewsphere::frame::Size;
use viewsphere::gpu::reflect;
use viewsphere::kernel::Kernel;
use viewsphere::kernels::{self, compare};

const SIZES: [Size; 4] = [Size::new(1, 1), Size::new(7, 5), Size::new(65, 33), Size::new(641, 363)];

fn compare_sides(kernel: &Kernel) {
    let Some(gpu) = common::gpu() else { return };
    for size in SIZES {
        for case in (kernel.cases)(size) {
            let inputs: Vec<&[f32]> = case.inputs.iter().map(Vec::as_slice).collect();
            let mut expected: Vec<Vec<f32>> =
                case.outputs.iter().map(|len| vec![compare::POISON; *len]).collect();
            let mut outputs: Vec<&mut [f32]> = expected.iter_mut().map(Vec::as_mut_slice).collect();
            (kernel.reference)(&case.params, &inputs, &mut outputs);
            let extent = [case.extent.width, case.extent.height];
            let found = gpu
                .run_kernel(kernel, &case.params, &inputs, &case.outputs, extent)
                .unwrap_or_else(|error| panic!("{error}"));
            for ((name, expected), found) in kernel.outputs.iter().zip(&expected).zip(&found) {
                let difference = compare::compare(expected, found, kernel.tolerance);
                assert!(
                    difference.breaches == 0,
                    "{} at {size}, {}: {name} {difference:?}, of the pictures' {}",
                    kernel.name,
                    case.name,
                    case.extent,
                );
                println!("{} at {size}, {}: {name} max {:e}", kernel.name, case.name, difference.max);
            }
        }
    }
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
