//! The two sides of a kernel, run on the kernel's own cases and held against each other.

use std::ops::ControlFlow;

use viewsphere::Result;
use viewsphere::frame::Size;
use viewsphere::gpu::Gpu;
use viewsphere::kernel::Kernel;
use viewsphere::kernels::compare::{Difference, POISON, compare};

/// The smallest picture, one with a part of a vector and of a workgroup, one just over whole ones, and a large odd one.
pub(crate) const SIZES: [Size; 4] =
    [Size::new(1, 1), Size::new(7, 5), Size::new(65, 33), Size::new(641, 363)];

/// One output of one case.
pub(crate) struct Compared {
    /// Kernel, size, case and output.
    pub(crate) what: String,
    /// How far the shader is from the reference.
    pub(crate) difference: Difference,
}

/// Runs both sides on every case at every size, small ones first, until `seen` breaks off.
pub(crate) fn compare_sides(
    gpu: &Gpu,
    kernel: &Kernel,
    mut seen: impl FnMut(Compared) -> ControlFlow<()>,
) -> Result<()> {
    for size in SIZES {
        for case in (kernel.cases)(size) {
            let inputs: Vec<&[f32]> = case.inputs.iter().map(Vec::as_slice).collect();
            let mut expected: Vec<Vec<f32>> = case.outputs.iter().map(|len| vec![POISON; *len]).collect();
            let mut outputs: Vec<&mut [f32]> = expected.iter_mut().map(Vec::as_mut_slice).collect();
            (kernel.reference)(&case.params, &inputs, &mut outputs);
            let extent = [case.extent.width, case.extent.height];
            let found = gpu.run_kernel(kernel, &case.params, &inputs, &case.outputs, extent)?;
            let known: Vec<&[f32]> = expected.iter().map(Vec::as_slice).collect();
            let bounds = kernel.bounds(&case.params, &inputs, &known);
            for (((name, expected), found), bound) in
                kernel.outputs.iter().zip(&expected).zip(&found).zip(&bounds)
            {
                let what = format!("{} at {size}, {}: {name} of {}", kernel.name, case.name, case.extent);
                if seen(Compared { what, difference: compare(expected, found, bound) }).is_break() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}
