//! The kernels, one file each, and their registry.
//!
//! To add one: `shaders/foo.wgsl`, `src/kernels/foo.rs`, and the word `foo` in the list below. The list generates the
//! shader's checks, its pipeline and a named test of GPU against CPU; `viewsphere bench` and `crosscheck` show the
//! kernels that a plan uses.

mod bearings;
pub mod compare;
mod expansion_pair;
pub(crate) mod hash;
mod lens;
mod octaves;
pub(crate) mod parallel_rows;
mod surface_inputs;
pub mod surface_layout;
pub mod tables;
pub mod test_inputs;
mod track_points_bound;
mod track_points_cases;
mod window_samples;

macro_rules! registry {
    (($d:tt) $($kernel:ident),* $(,)?) => {
        $(pub mod $kernel;)*

        /// Every kernel.
        pub static ALL: &[&crate::kernel::Kernel] = &[$(&$kernel::KERNEL),*];

        /// Calls a macro with the names of all kernels, so that tests are generated from this list.
        #[macro_export]
        macro_rules! for_each_kernel {
            ($d call:ident) => { $d call! { $($kernel),* } };
        }
    };
}

registry!(
    ($)
    luma,
    premultiply,
    binomial,
    resample_y,
    resample_x,
    expansion_y,
    expansion_x,
    normalized_expansion_y,
    normalized_expansion_x,
    upsample,
    downsample_flow,
    normal_equations,
    weighted_normal_equations,
    robust_equations,
    weighted_robust_equations,
    older_equations,
    keep_expansion,
    carry,
    slope_weights,
    expected_slope,
    smoothness,
    links,
    sweep,
    misfit,
    steadiness,
    block_mean,
    surroundings,
    fit_weight,
    nonlocal,
    window_y,
    solve,
    solve_increment,
    affine_columns,
    solve_affine,
    residual,
    confidence,
    warp,
    gradient_equations,
    cubic_warp,
    brightness_equations,
    transport,
    correct,
    unweight,
    structure_tensor,
    block_sum,
    corner_response,
    local_maxima,
    row_maximum,
    pyr_down,
    patches,
    track_points,
    undistort_map,
    remap,
    rotational_flow,
    spherical_flow,
    cell_confidence,
    cell_evidence,
    cell_mean,
    cells,
    looming,
    sectors,
    cast,
    shade,
    sensor,
);
