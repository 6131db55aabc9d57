//! The two sides of a kernel, run on the kernel's own cases and compared.

use std::ops::ControlFlow;

use viewsphere::Result;
use viewsphere::frame::Size;
use viewsphere::gpu::{Gpu, Tuning};
use viewsphere::kernel::Kernel;
use viewsphere::kernels::compare::{Difference, POISON, compare};

/// The smallest image, one with a partial vector and workgroup, one just over whole ones, and a large odd one.
pub(crate) const SIZES: [Size; 4] =
    [Size::new(1, 1), Size::new(7, 5), Size::new(65, 33), Size::new(641, 363)];

/// One output of one case, by one variant of the shader.
pub(crate) struct Compared {
    /// Kernel, variant, size, case and output.
    pub(crate) what: String,
    /// The difference between shader and reference.
    pub(crate) difference: Difference,
    /// Whether the bits equal those of the default variant.
    pub(crate) as_default: bool,
}

/// Runs the reference and every variant of the shader on every case at every size, small ones first, until `seen`
/// breaks.
pub(crate) fn compare_sides(
    gpu: &Gpu,
    kernel: &Kernel,
    mut seen: impl FnMut(Compared) -> ControlFlow<()>,
) -> Result<()> {
    let mut variants = Vec::new();
    for variant in kernel.variants {
        let mut tuning = Tuning::default();
        tuning.set(gpu.adapter().class, kernel, variant.name)?;
        variants.push((variant.name, gpu.with_tuning(tuning)));
    }
    for size in SIZES {
        for case in (kernel.cases)(size) {
            let inputs: Vec<&[f32]> = case.inputs.iter().map(Vec::as_slice).collect();
            let mut expected: Vec<Vec<f32>> = case.outputs.iter().map(|len| vec![POISON; *len]).collect();
            let mut outputs: Vec<&mut [f32]> = expected.iter_mut().map(Vec::as_mut_slice).collect();
            (kernel.reference)(&case.params, &inputs, &mut outputs);
            let extent = [case.extent.width, case.extent.height];
            let known: Vec<&[f32]> = expected.iter().map(Vec::as_slice).collect();
            let bounds = kernel.bounds(&case.params, &inputs, &known);
            let mut default = None;
            for (variant, gpu) in &variants {
                let found = gpu.run_kernel(kernel, &case.params, &inputs, &case.outputs, extent)?;
                let default: &Vec<Vec<f32>> = default.get_or_insert_with(|| found.clone());
                for (i, name) in kernel.outputs.iter().enumerate() {
                    let (kernel, case, extent) = (kernel.name, &case.name, case.extent);
                    let bits =
                        |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                    let compared = Compared {
                        what: format!("{kernel}, {variant}, at {size}, {case}: {name} of {extent}"),
                        difference: compare(&expected[i], &found[i], &bounds[i]),
                        as_default: bits(&found[i]) == bits(&default[i]),
                    };
                    if seen(compared).is_break() {
                        return Ok(());
                    }
                }
            }
        }
    }
    Ok(())
}
