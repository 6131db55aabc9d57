//! Text of enums: each variant has a name, which is what `Display` writes and `FromStr` reads.

/// Implements `Display` and `FromStr` of an enum by its `ALL` and `name`. The text is what an error calls it.
macro_rules! named {
    ($type:ty, $what:literal) => {
        impl ::std::fmt::Display for $type {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl ::std::str::FromStr for $type {
            type Err = $crate::error::Error;

            fn from_str(text: &str) -> $crate::error::Result<Self> {
                Self::ALL.into_iter().find(|known| known.name() == text).ok_or_else(|| {
                    let known = Self::ALL.map(Self::name).join(", ");
                    $crate::error::Error::parameter($what, format_args!("{text:?}"), known)
                })
            }
        }
    };
}

pub(crate) use named;
