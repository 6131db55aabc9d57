//! Estimators of optical flow. Each one builds the steps of a [`Plan`](crate::plan::Plan) and follows its paper.
//!
//! To add one: `src/flow/foo.rs` with a type that is an [`Estimator`], its kernels, and the word `foo` with the type's
//! name in the list below. The list generates its variant of [`Algorithm`], its name and its parameters' flags on the
//! command line and in JSON, its tests of determinism, sizes and streams, and its place in `crosscheck` and `bench`.

mod coarse_to_fine;
mod estimator;
mod expansions;
mod flow_plan;
mod gradients;
mod images;
mod levels;
mod normalized;
mod parameter;
mod pyramid;

pub use estimator::{Estimator, Evidence, Stages, Wanted};
pub(crate) use flow_plan::gray_step;
pub use flow_plan::{FlowOptions, Initial, plan};
pub use levels::{Level, levels};
pub use parameter::{Choice, Parameter, Parameters};

use crate::error::{Error, Result};
use crate::frame::Size;
use crate::plan::Bufs;

macro_rules! estimators {
    (($d:tt) $($module:ident: $Type:ident),* $(,)?) => {
        $(mod $module;)*
        $(pub use $module::$Type;)*

        /// A method that estimates optical flow, with its parameters.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        #[cfg_attr(feature = "serde", derive(serde::Serialize))]
        pub enum Algorithm {
            $(#[allow(missing_docs, reason = "the type says what it is")] $Type($Type)),*
        }

        $(impl From<$Type> for Algorithm {
            fn from(parameters: $Type) -> Self {
                Self::$Type(parameters)
            }
        }

        impl From<&$Type> for Algorithm {
            fn from(parameters: &$Type) -> Self {
                Self::$Type(parameters.clone())
            }
        })*

        impl Algorithm {
            /// The names of all methods, each with a one-line description.
            pub const ALL: &'static [Choice] = &[$((<$Type>::NAME, <$Type>::ABOUT)),*];

            /// The method of this name with the values of a preset.
            ///
            /// # Errors
            /// [`Error::Parameter`] for an unknown method or preset.
            pub fn named(name: &str, preset: &str) -> Result<Self> {
                $(if name == <$Type>::NAME {
                    return match <$Type>::preset(preset) {
                        Some(parameters) => Ok(Self::$Type(parameters)),
                        None => Err(unknown_preset(preset, name, <$Type>::PRESETS)),
                    };
                })*
                Err(unknown("algorithm", format_args!("{name:?}"), Self::ALL))
            }

            /// The names of the methods that have a preset of this name.
            pub fn with_preset(preset: &str) -> Vec<&'static str> {
                let all = [$((<$Type>::NAME, <$Type>::PRESETS)),*];
                let has_it = |presets: &[Choice]| presets.iter().any(|(name, _)| *name == preset);
                all.into_iter().filter(|(_, presets)| has_it(presets)).map(|(name, _)| name).collect()
            }

            /// The method's name.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$Type(_) => <$Type>::NAME),* }
            }

            /// The method's parameters.
            pub fn parameters(&self) -> &'static [Parameter] {
                match self { $(Self::$Type(_) => <$Type>::LIST),* }
            }

            /// Whether the flow of a pair depends on the earlier pairs of its stream. A first pair, and one after a reset,
            /// has none.
            pub fn has_memory(&self) -> bool {
                match self { $(Self::$Type(parameters) => Estimator::has_memory(parameters)),* }
            }

            /// The number of frames from which the flow of a pair is computed: 2, or 3 where the frame before the pair counts
            /// too. The first pair of a stream, and one after a reset, has only its own two.
            pub fn frames(&self) -> u32 {
                match self { $(Self::$Type(parameters) => Estimator::frames(parameters)),* }
            }

            /// The method's presets.
            pub fn presets(&self) -> &'static [Choice] {
                match self { $(Self::$Type(_) => <$Type>::PRESETS),* }
            }

            /// The value of a parameter as text; `None` if the method has no parameter of this name.
            pub fn get(&self, name: &str) -> Option<String> {
                match self { $(Self::$Type(parameters) => parameters.get(name)),* }
            }

            /// Sets a parameter from text.
            ///
            /// # Errors
            /// [`Error::Parameter`] for an unknown parameter, and for text that is not one of its values.
            pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
                match self { $(Self::$Type(parameters) => parameters.set(name, value)),* }
            }

            /// Checks every parameter's range.
            ///
            /// # Errors
            /// [`Error::Parameter`], naming the first one that is out of range.
            pub fn validate(&self) -> Result<()> {
                match self { $(Self::$Type(parameters) => Estimator::validate(parameters)),* }
            }

            pub(crate) fn stages(&self, bufs: &mut Bufs, size: Size, wanted: Wanted) -> Box<dyn Stages> {
                match self { $(Self::$Type(parameters) => Estimator::stages(parameters, bufs, size, wanted)),* }
            }
        }

        /// Calls a macro with the modules and types of all estimators, so that tests are generated from this list.
        #[macro_export]
        macro_rules! for_each_estimator {
            ($d call:ident) => { $d call! { $($module: $Type),* } };
        }
    };
}

estimators!(
    ($)
    farneback: Farneback,
    farneback_tv: FarnebackTv,
    flow_filter: FlowFilter,
    horn_schunck: HornSchunck,
    lucas_kanade: LucasKanade,
);

pub use farneback::{Border, Motion, Outside, Update, Window};
pub use horn_schunck::Penalty;

impl Default for Algorithm {
    fn default() -> Self {
        Self::Farneback(Farneback::default())
    }
}

fn unknown_preset(preset: &str, algorithm: &str, known: &[Choice]) -> Error {
    let mut names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    let others = Algorithm::with_preset(preset).join(" or ");
    let algorithm_with_it = format!("or the algorithm {others}, which has it");
    if !others.is_empty() {
        names.push(&algorithm_with_it);
    }
    Error::parameter("preset", format_args!("{preset:?} with {algorithm}"), names.join(", "))
}

fn unknown(what: &'static str, found: impl std::fmt::Display, known: &[Choice]) -> Error {
    let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    Error::parameter(what, found, names.join(", "))
}
