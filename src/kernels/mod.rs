//! The kernels, one file each, and their registry.
//!
//! To add one: `shaders/foo.wgsl`, `src/kernels/foo.rs`, and the word `foo` in the list below. The shader's checks,
//! its pipeline and a named test of GPU against CPU follow from the list; `viewsphere bench` and `crosscheck` show what a
//! plan uses.

pub mod cases;
pub mod compare;
mod facet_cases;
pub mod facets;
pub(crate) mod hash;
mod lens;
mod octaves;
mod pair;
pub(crate) mod rows;
mod sighting;
pub mod tables;

macro_rules! registry {
    (($d:tt) $($kernel:ident),* $(,)?) => {
        $(pub mod $kernel;)*

        /// Every kernel.
        pub static ALL: &[&crate::kernel::Kernel] = &[$(&$kernel::KERNEL),*];

        /// Calls a macro with the names of all kernels, so that tests are made from the one list.
        #[macro_export]
        macro_rules! for_each_kernel {
            ($d call:ident) => { $d call! { $($kernel),* } };
        }
    };
}

registry!(
    ($)
    luma,
    weigh,
    binomial,
    resample_y,
    resample_x,
    expansion_y,
    expansion_x,
    certain_expansion_y,
    certain_expansion_x,
    upsample,
    area,
    matrices,
    certain_matrices,
    window_y,
    solve,
    advance,
    residual,
    confidence,
    warp,
    gradient_equations,
    unweight,
    lens_map,
    remap,
    prime,
    tangent,
    trust,
    cell_mean,
    cells,
    looming,
    sectors,
    cast,
    shade,
    sensor,
);
