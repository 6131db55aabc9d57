//! What a kernel is: one pure function, written once in WGSL and once in Rust, with the cases and the bound by which
//! the two are compared.

use crate::frame::Size;

/// A pure function from parameters and input buffers to output buffers.
///
/// In WGSL binding 0 is `params` (uniform), then come the inputs (read-only storage), then the outputs, and the entry
/// point is `main`. In Rust the reference takes the same things in the same order. Buffers are `f32`; a plane of a
/// picture has rows of [`Size::stride`] values, whose surplus repeats the row's last pixel, and a picture of several
/// channels holds row 0 of each channel, then row 1 of each channel, and so on.
#[derive(Clone, Copy)]
pub struct Kernel {
    /// The one name: of the shader file, the module, the label, the test and the bench.
    pub name: &'static str,
    /// The WGSL text: the kernel's file, then the library files that it uses.
    pub source: &'static str,
    /// The uniform struct, as Rust lays it out.
    pub params: Layout,
    /// Names of the input buffers, in the order of their bindings.
    pub inputs: &'static [&'static str],
    /// Names of the output buffers, in the order of their bindings.
    pub outputs: &'static [&'static str],
    /// The CPU side. Parameters come as the bytes of the uniform struct.
    pub reference: Reference,
    /// Inputs to compare the two sides on, for a picture of the given size.
    pub cases: fn(Size) -> Vec<Case>,
    /// How far the two sides may differ, and why.
    pub tolerance: Tolerance,
}

/// The CPU side of a kernel: bytes of the parameters, inputs, outputs.
pub type Reference = fn(&[u8], &[&[f32]], &mut [&mut [f32]]);

/// A uniform struct as Rust lays it out, to be compared with what the shader declares.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Bytes of the struct.
    pub size: usize,
    /// The fields in order.
    pub fields: &'static [Field],
}

/// One field of a [`Layout`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// The field's name.
    pub name: &'static str,
    /// Bytes from the struct's beginning.
    pub offset: usize,
    /// The WGSL name of its type.
    pub ty: &'static str,
}

/// One set of arguments to compare the two sides of a kernel on.
#[derive(Clone, Debug)]
pub struct Case {
    /// What is special about it, for example `textured`.
    pub name: String,
    /// Bytes of the parameters.
    pub params: Vec<u8>,
    /// The input buffers.
    pub inputs: Vec<Vec<f32>>,
    /// Lengths of the output buffers.
    pub outputs: Vec<usize>,
    /// Width and height of what is computed.
    pub extent: Size,
}

/// How far two results may lie apart: `|a − b| ≤ absolute + relative · |reference| + of_largest · largest`.
///
/// `largest` is the largest magnitude in the kernel's first input and in the reference's output: sums that cancel keep
/// the roundings of their terms.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// The absolute part.
    pub absolute: f32,
    /// The part that grows with the reference's magnitude.
    pub relative: f32,
    /// The part that grows with the largest value that is about.
    pub of_largest: f32,
    /// Why this much and not less.
    pub reason: &'static str,
}

impl Tolerance {
    /// The tolerance for one run, with its share of the largest value made part of the absolute one.
    pub fn over(self, first_input: &[f32], expected: &[f32]) -> Self {
        let values =
            first_input.iter().chain(expected).map(|value| value.abs()).filter(|value| value.is_finite());
        let largest = if self.of_largest > 0.0 { values.fold(0.0, f32::max) } else { 0.0 };
        Self { absolute: self.absolute + self.of_largest * largest, of_largest: 0.0, ..self }
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

/// Defines a kernel's uniform struct and notes its layout, so that naga can compare it with the shader's.
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

/// The text of a shader: `shaders/<kernel>.wgsl`, then the named files of `shaders/lib/`.
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
macro_rules! kernel {
    (
        $name:literal + [$($lib:literal),*],
        $reference:ident($params:ident; $($input:ident),*) -> ($($output:ident),*),
        cases: $cases:expr,
        tolerance: $tolerance:expr $(,)?
    ) => {
        /// The kernel, for the registry.
        pub static KERNEL: $crate::kernel::Kernel = $crate::kernel::Kernel {
            name: $name,
            source: $crate::kernel::wgsl!($name $(, $lib)*),
            params: $params::LAYOUT,
            inputs: &[$(stringify!($input)),*],
            outputs: &[$(stringify!($output)),*],
            reference: |params, inputs, outputs| {
                let params: $params = bytemuck::pod_read_unaligned(params);
                let ([$($input),*], [$($output),*]) = (inputs, outputs) else {
                    unreachable!("a plan checks the number of buffers when it is built");
                };
                $reference(&params, $($input,)* $($output),*);
            },
            cases: $cases,
            tolerance: $tolerance,
        };
    };
}

pub(crate) use {kernel, params, wgsl};
