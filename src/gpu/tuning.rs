//! Tuning: the variant of each kernel that an adapter runs.

use std::collections::BTreeMap;
use std::fmt;

use wgpu::{AdapterInfo, DeviceType};

use crate::error::{Error, Result};
use crate::kernel::{Kernel, Variant};

/// The class of an adapter: kernels are tuned for each class, not for each product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AdapterClass {
    /// An adapter that computes on the CPU, such as lavapipe.
    Software,
    /// An integrated GPU of a desktop or laptop, which shares the CPU's memory.
    Integrated,
    /// A discrete GPU, with memory of its own.
    Discrete,
    /// The GPU of a phone or a single-board computer, known by its maker.
    Mobile,
    /// A virtual GPU, or one whose driver does not say what it is.
    Other,
}

impl AdapterClass {
    /// Every class.
    pub const ALL: [Self; 5] = [Self::Software, Self::Integrated, Self::Discrete, Self::Mobile, Self::Other];

    pub(super) fn of(info: &AdapterInfo) -> Self {
        /// PCI vendor numbers (or, for a maker without one, Khronos's numbers) of GPUs that exist only in systems on a
        /// chip: Imagination, Arm, Samsung, Broadcom, Qualcomm, Vivante, VeriSilicon.
        const MOBILE: [u32; 7] = [0x1010, 0x13b5, 0x144d, 0x14e4, 0x5143, 0x1_0001, 0x1_0002];
        match info.device_type {
            DeviceType::Cpu => Self::Software,
            DeviceType::DiscreteGpu => Self::Discrete,
            DeviceType::VirtualGpu => Self::Other,
            DeviceType::IntegratedGpu | DeviceType::Other if MOBILE.contains(&info.vendor) => Self::Mobile,
            DeviceType::IntegratedGpu => Self::Integrated,
            DeviceType::Other => Self::Other,
        }
    }
}

impl fmt::Display for AdapterClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Software => "software",
            Self::Integrated => "integrated",
            Self::Discrete => "discrete",
            Self::Mobile => "mobile",
            Self::Other => "other",
        })
    }
}

/// The [`Variant`] of each kernel for each class of adapters.
///
/// The default tuning takes each kernel's first variant on every adapter.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tuning {
    /// From class and kernel to the variant, all by name: a test's mutated kernel is tuned as the original.
    chosen: BTreeMap<(AdapterClass, &'static str), &'static str>,
}

impl Tuning {
    /// Chooses a kernel's variant on the adapters of a class.
    ///
    /// # Errors
    /// [`Error::Kernel`] if the kernel has no variant of this name.
    pub fn set(&mut self, class: AdapterClass, kernel: &Kernel, variant: &str) -> Result<()> {
        let name = find(kernel, variant)?.name;
        self.chosen.insert((class, kernel.name), name);
        Ok(())
    }

    /// The variant of a kernel on the adapters of a class.
    ///
    /// # Errors
    /// [`Error::Kernel`] if the kernel has no variants, or lacks the variant that was chosen for a kernel of the same
    /// name.
    pub fn variant(&self, class: AdapterClass, kernel: &Kernel) -> Result<&'static Variant> {
        match self.chosen.get(&(class, kernel.name)) {
            Some(name) => find(kernel, name),
            None => kernel.variants.first().ok_or_else(|| Error::Kernel {
                kernel: kernel.name.to_owned(),
                problem: "no variants, expected at least the default".to_owned(),
            }),
        }
    }
}

fn find(kernel: &Kernel, name: &str) -> Result<&'static Variant> {
    kernel.variants.iter().find(|variant| variant.name == name).ok_or_else(|| {
        let names: Vec<&str> = kernel.variants.iter().map(|variant| variant.name).collect();
        let problem = format!("variant is {name}, expected one of: {}", names.join(", "));
        Error::Kernel { kernel: kernel.name.to_owned(), problem }
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::kernels::{luma, window_y};

    #[test]
    fn a_variant_is_chosen_for_its_class_alone() {
        let mut tuning = Tuning::default();
        tuning.set(AdapterClass::Mobile, &window_y::KERNEL, "wide").unwrap();
        for class in AdapterClass::ALL {
            let expected = if class == AdapterClass::Mobile { "wide" } else { "default" };
            assert_eq!(tuning.variant(class, &window_y::KERNEL).unwrap().name, expected, "{class}");
            assert_eq!(tuning.variant(class, &luma::KERNEL).unwrap().name, "default", "{class}");
        }
    }

    #[test]
    fn a_variant_that_is_not_there_is_refused() {
        let mut tuning = Tuning::default();
        let error = tuning.set(AdapterClass::Other, &window_y::KERNEL, "round").unwrap_err();
        assert!(matches!(&error, Error::Kernel { .. }), "{error}");
        assert!(error.to_string().starts_with("window_y: variant is round, expected one of: default, wide"));
        assert_eq!(tuning, Tuning::default());
        let none = Kernel { variants: &[], ..luma::KERNEL };
        assert!(matches!(tuning.variant(AdapterClass::Other, &none), Err(Error::Kernel { .. })));
    }
}
