//! Each kernel's reference on the CPU, at 640×480: `cargo bench --bench kernels`, or `… --bench kernels -- solve`.
//!
//! `-- --test` runs each once. `viewsphere bench` times a whole pair, step by step, on either executor.

use std::fmt;

use divan::counter::ItemsCount;
use viewsphere::frame::Size;
use viewsphere::kernel::Kernel;
use viewsphere::kernels::ALL;

const SIZE: Size = Size::new(640, 480);

fn main() {
    divan::main();
}

/// A kernel, displayed by its name.
struct Named(&'static Kernel);

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

fn kernels() -> impl Iterator<Item = Named> {
    ALL.iter().map(|kernel| Named(kernel))
}

/// The first of the cases on which the two sides are compared.
#[divan::bench(args = kernels())]
fn reference(bencher: divan::Bencher<'_, '_>, Named(kernel): &Named) {
    let case = (kernel.cases)(SIZE).swap_remove(0);
    let inputs: Vec<&[f32]> = case.inputs.iter().map(Vec::as_slice).collect();
    let mut values: Vec<Vec<f32>> = case.outputs.iter().map(|len| vec![0.0; *len]).collect();
    let mut outputs: Vec<&mut [f32]> = values.iter_mut().map(Vec::as_mut_slice).collect();
    bencher
        .counter(ItemsCount::new(case.extent.pixels()))
        .bench_local(|| (kernel.reference)(&case.params, &inputs, &mut outputs));
}
