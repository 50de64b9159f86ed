//! Names of the values of an enum, stated once for every place that reads or writes them.

/// Gives the values of an enum names: `ALL`, `name`, `Display` and `FromStr`. `$what` names the parameter in errors.
macro_rules! names {
    ($enum:ident, $what:literal, { $($variant:ident => $name:literal),+ $(,)? }) => {
        impl $enum {
            /// All values.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            /// The name of the value, as `Display` writes and `FromStr` reads it.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl std::fmt::Display for $enum {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $enum {
            type Err = $crate::Error;

            fn from_str(text: &str) -> $crate::Result<Self> {
                Self::ALL.into_iter().find(|value| value.name() == text).ok_or_else(|| $crate::Error::Parameter {
                    name: $what,
                    value: format!("'{text}'"),
                    expected: format!("it must be one of {}", [$($name),+].join(", ")),
                })
            }
        }
    };
}

pub(crate) use names;
