//! The kernel: one pure function, written once in WGSL and once in Rust, with the cases and the bound for comparing the
//! two.

use crate::frame::Size;

/// A pure function from parameters and input buffers to output buffers.
///
/// In WGSL binding 0 is `params` (uniform), then come the inputs (read-only storage), then the outputs, and the entry
/// point is `main`. In Rust the reference takes the same arguments in the same order. Buffers are `f32`. A plane has
/// rows of [`Size::stride`] values, whose surplus repeats the row's last pixel; an image of several channels holds row
/// 0 of each channel, then row 1 of each channel, and so on.
#[derive(Clone, Copy)]
pub struct Kernel {
    /// The name of the shader file, the module, the label, the test and the benchmark: all the same.
    pub name: &'static str,
    /// The WGSL text: the kernel's file, then the library files that it uses.
    pub source: &'static str,
    /// The layout of the uniform struct in Rust.
    pub params: Layout,
    /// Names of the input buffers, in the order of their bindings.
    pub inputs: &'static [&'static str],
    /// Names of the output buffers, in the order of their bindings.
    pub outputs: &'static [&'static str],
    /// The CPU side. Its parameters are the bytes of the uniform struct.
    pub reference: Reference,
    /// The cases on which the two sides are compared, for an image of the given size.
    pub cases: fn(Size) -> Vec<Case>,
    /// The largest allowed difference between the two sides, and its reason.
    pub tolerance: Tolerance,
    /// The largest difference that roundings alone may cause, value by value, where it depends on the values. It is
    /// computed from the parameters and inputs of the reference, and added to the tolerance.
    pub rounding: Option<Reference>,
    /// The sets of constants that the shader can be compiled with. The first one is the default.
    pub variants: &'static [Variant],
}

/// A named set of values for a shader's `override` constants, such as a workgroup's size. A variant changes how the
/// work is divided, not the result: the kernel's tolerance applies to every variant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// The name, for a [`Tuning`](crate::gpu::Tuning), messages and tests.
    pub name: &'static str,
    /// Names of `override` constants and their values. Other constants keep the shader's value.
    pub constants: &'static [(&'static str, f64)],
}

impl Variant {
    /// The default variant: the shader's own values.
    pub const DEFAULT: Self = Self { name: "default", constants: &[] };
}

impl Kernel {
    /// The bounds of one run, one per output, from its arguments and the reference's outputs.
    pub fn bounds(&self, params: &[u8], inputs: &[&[f32]], expected: &[&[f32]]) -> Vec<Bound> {
        let mut own = vec![Vec::new(); expected.len()];
        if let Some(rounding) = self.rounding {
            // A bound that is not written is NaN, and no value lies within it.
            own = expected.iter().map(|values| vec![f32::NAN; values.len()]).collect();
            rounding(params, inputs, &mut own.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
        }
        let Tolerance { absolute, relative, of_largest, .. } = self.tolerance;
        let bound = |(own, expected): (Vec<f32>, &&[f32])| {
            let largest = if of_largest > 0.0 { largest(inputs[0]).max(largest(expected)) } else { 0.0 };
            Bound { absolute: absolute + of_largest * largest, relative, own }
        };
        own.into_iter().zip(expected).map(bound).collect()
    }
}

/// The largest magnitude; 0 for no values.
fn largest(values: &[f32]) -> f32 {
    values.iter().map(|value| value.abs()).filter(|value| value.is_finite()).fold(0.0, f32::max)
}

/// The CPU side of a kernel. Arguments: the bytes of the parameters, the input buffers, the output buffers.
pub type Reference = fn(&[u8], &[&[f32]], &mut [&mut [f32]]);

/// The layout of a uniform struct in Rust, to compare with the shader's declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layout {
    /// Size of the struct in bytes.
    pub size: usize,
    /// The fields in order.
    pub fields: &'static [Field],
}

/// One field of a [`Layout`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Field {
    /// The field's name.
    pub name: &'static str,
    /// Offset from the struct's beginning, in bytes.
    pub offset: usize,
    /// The WGSL name of its type.
    pub ty: &'static str,
}

/// One set of arguments for comparing the two sides of a kernel.
#[derive(Clone, Debug)]
pub struct Case {
    /// The case's name, for example `textured`.
    pub name: String,
    /// The bytes of the parameters.
    pub params: Vec<u8>,
    /// The input buffers.
    pub inputs: Vec<Vec<f32>>,
    /// Lengths of the output buffers.
    pub outputs: Vec<usize>,
    /// Width and height of the computed image.
    pub extent: Size,
}

/// The largest allowed difference of two results: `|a − b| ≤ absolute + relative · |reference| + of_largest · largest`,
/// plus what [`Kernel::rounding`] adds.
///
/// `largest` is the largest magnitude in the kernel's first input and in the reference's output: sums that cancel keep
/// the roundings of their terms.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// The absolute part.
    pub absolute: f32,
    /// The part that grows with the reference's magnitude.
    pub relative: f32,
    /// The part that grows with the largest value.
    pub of_largest: f32,
    /// The reason for this size.
    pub reason: &'static str,
}

/// The largest allowed difference of the values of one output in one run: `absolute + relative · |reference| + own`.
#[derive(Clone, Debug, Default)]
pub struct Bound {
    /// The absolute part, with the tolerance's share of the largest value.
    pub absolute: f32,
    /// The part that grows with the reference's magnitude.
    pub relative: f32,
    /// Each value's own part, one per value of the output; empty if the kernel's tolerance is the whole bound.
    pub own: Vec<f32>,
}

impl Bound {
    /// The bound of the value at an index, whose reference is `expected`. NaN for a value beyond the end of an own part
    /// that is not empty.
    pub fn at(&self, index: usize, expected: f32) -> f32 {
        let magnitude = if expected.is_finite() { expected.abs() } else { 0.0 };
        let own = if self.own.is_empty() { 0.0 } else { self.own.get(index).copied().unwrap_or(f32::NAN) };
        self.absolute + self.relative * magnitude + own
    }

    /// The bound multiplied by a factor.
    pub fn times(mut self, factor: f32) -> Self {
        self.own.iter_mut().for_each(|own| *own *= factor);
        Self { absolute: factor * self.absolute, relative: factor * self.relative, ..self }
    }
}

/// Types that a uniform struct may have as fields, with their names in WGSL.
pub trait UniformField {
    /// The type's name in WGSL.
    const WGSL: &'static str;
}

macro_rules! uniform_fields {
    ($($rust:ty => $wgsl:literal),* $(,)?) => { $(impl UniformField for $rust { const WGSL: &'static str = $wgsl; })* };
}
uniform_fields!(
    f32 => "f32", u32 => "u32", i32 => "i32",
    [f32; 2] => "vec2<f32>", [u32; 2] => "vec2<u32>", [i32; 2] => "vec2<i32>",
    [f32; 4] => "vec4<f32>", [u32; 4] => "vec4<u32>", [i32; 4] => "vec4<i32>",
);

/// Defines a kernel's uniform struct and records its layout, so that naga can compare it with the shader's.
macro_rules! params {
    ($(#[$meta:meta])* struct $name:ident { $($(#[$field_meta:meta])* $field:ident: $ty:ty,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $($(#[$field_meta])* pub $field: $ty,)* }

        impl $name {
            pub(crate) const LAYOUT: $crate::kernel::Layout = $crate::kernel::Layout {
                size: size_of::<$name>(),
                fields: &[$($crate::kernel::Field {
                    name: stringify!($field),
                    offset: std::mem::offset_of!($name, $field),
                    ty: <$ty as $crate::kernel::UniformField>::WGSL,
                },)*],
            };
        }
    };
}

/// The text of a shader: `shaders/<kernel>.wgsl`, followed by the named files of `shaders/lib/`.
///
/// The kernel comes first, so that line numbers in the compiler's messages are those of its file.
macro_rules! wgsl {
    ($kernel:literal $(, $lib:literal)*) => {
        concat!(
            include_str!(concat!("../../shaders/", $kernel, ".wgsl")),
            $(include_str!(concat!("../../shaders/lib/", $lib, ".wgsl")),)*
        )
    };
}

/// Defines `KERNEL`: the shader, the layout and a call of the reference with its arguments unpacked.
///
/// Two arguments may follow: `rounding`, the bound's own part, a function of the reference's arguments; and `variants`
/// beside the default, `{ name: { CONSTANT = value, … }, … }`.
macro_rules! kernel {
    (
        $name:literal + [$($lib:literal),*],
        $reference:ident $arguments:tt -> $outputs:tt,
        cases: $cases:expr,
        tolerance: $tolerance:expr
        $(, rounding: $rounding:ident)?
        $(, variants: $variants:tt)?
        $(,)?
    ) => {
        $crate::kernel::kernel!(
            @define $name + [$($lib),*], $reference $arguments -> $outputs, $cases, $tolerance,
            $crate::kernel::kernel!(@option $($rounding $arguments -> $outputs)?),
            $crate::kernel::kernel!(@variants $($variants)?)
        );
    };
    (@option) => { None };
    (@option $function:ident $arguments:tt -> $outputs:tt) => {
        Some($crate::kernel::kernel!(@call $function $arguments -> $outputs))
    };
    (@variants) => { &[$crate::kernel::Variant::DEFAULT] };
    (@variants { $($variant:ident: { $($constant:ident = $value:literal),+ $(,)? }),+ $(,)? }) => {
        &[
            $crate::kernel::Variant::DEFAULT,
            $($crate::kernel::Variant {
                name: stringify!($variant),
                constants: &[$((stringify!($constant), $value as f64)),+],
            },)+
        ]
    };
    (@call $function:ident($params:ident; $($input:ident),*) -> ($($output:ident),*)) => {
        |params, inputs, outputs| {
            let params: $params = bytemuck::pod_read_unaligned(params);
            let ([$($input),*], [$($output),*]) = (inputs, outputs) else {
                unreachable!("a plan checks the number of buffers when it is built");
            };
            $function(&params, $($input,)* $($output),*);
        }
    };
    (
        @define $name:literal + [$($lib:literal),*],
        $reference:ident($params:ident; $($input:ident),*) -> ($($output:ident),*),
        $cases:expr, $tolerance:expr, $rounding:expr, $variants:expr
    ) => {
        /// The kernel, for the registry.
        pub static KERNEL: $crate::kernel::Kernel = $crate::kernel::Kernel {
            name: $name,
            source: $crate::kernel::wgsl!($name $(, $lib)*),
            params: $params::LAYOUT,
            inputs: &[$(stringify!($input)),*],
            outputs: &[$(stringify!($output)),*],
            reference: $crate::kernel::kernel!(
                @call $reference($params; $($input),*) -> ($($output),*)
            ),
            cases: $cases,
            tolerance: $tolerance,
            rounding: $rounding,
            variants: $variants,
        };
    };
}

pub(crate) use {kernel, params, wgsl};
