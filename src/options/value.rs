//! The values of options, from text.

use std::str::FromStr;

use crate::{
    config::Preset,
    dense::{Compared, Interpolation, Paths, View},
    names::names,
};

/// The kind of an option's values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `true` or `false`.
    Flag,
    /// A whole number.
    Whole,
    /// A number.
    Number,
    /// One of several names.
    Choice(Vec<Choice>),
}

/// A value of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The name of the value.
    pub name: &'static str,
    /// What the value means; empty where the name says it.
    pub help: &'static str,
}

/// The name of a method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MethodName {
    /// Block matching or semi-global matching: see [`crate::dense`].
    #[default]
    Hsad,
    /// The method that the paper compares itself with: see [`crate::kamencay`].
    Kamencay,
}

names!(MethodName, "the method", { Hsad => "hsad", Kamencay => "kamencay" });

/// The number of paths of semi-global matching; `None` stands for 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathCount(pub Option<Paths>);

/// What an option can have as its value.
pub(super) trait Value: Sized {
    fn kind() -> Kind;
    /// The value, or what it must be.
    fn read(text: &str) -> Result<Self, String>;
    /// Whether the value counts as given.
    fn is_on(&self) -> bool {
        true
    }
}

impl Value for bool {
    fn kind() -> Kind {
        Kind::Flag
    }

    fn read(text: &str) -> Result<Self, String> {
        text.parse().map_err(|_| "it must be true or false".into())
    }

    fn is_on(&self) -> bool {
        *self
    }
}

/// Numbers.
macro_rules! numbers {
    ($($type:ty: $kind:ident, $what:literal;)+) => { $(
        impl Value for $type {
            fn kind() -> Kind {
                Kind::$kind
            }

            fn read(text: &str) -> Result<Self, String> {
                text.parse().map_err(|_| concat!("it must be ", $what).into())
            }
        }
    )+ };
}

numbers! {
    u32: Whole, "a whole number from 0 to 4294967295";
    i32: Whole, "a whole number from -2147483648 to 2147483647";
    f32: Number, "a number";
}

/// The choice that `text` names, or which there are.
fn chosen<T: FromStr>(text: &str, choices: &[Choice]) -> Result<T, String> {
    let names = || choices.iter().map(|choice| choice.name).collect::<Vec<_>>().join(", ");
    text.parse().map_err(|_| format!("it must be one of {}", names()))
}

/// Choices among all values of enums with names; a value without help does not compile.
macro_rules! choices {
    ($($enum:ident { $($variant:ident => $help:literal,)+ })+) => { $(
        impl Value for $enum {
            fn kind() -> Kind {
                let help = |value| match value { $($enum::$variant => $help,)+ };
                Kind::Choice(Self::ALL.map(|value| Choice { name: value.name(), help: help(value) }).into())
            }

            fn read(text: &str) -> Result<Self, String> {
                let Kind::Choice(choices) = Self::kind() else { return Err(String::new()) };
                chosen(text, &choices)
            }
        }
    )+ };
}

choices! {
    MethodName {
        Hsad => "Block matching or semi-global matching, depending on the preset",
        Kamencay => "Mean-shift segmentation and belief propagation, after Kamencay et al., for comparison",
    }
    Preset {
        Fast => "Block matching, coarse to fine, with holes where a match is not unique or its neighbours do not agree",
        Balanced => "Semi-global matching along 3 paths, with holes filled",
        Quality => "Semi-global matching along 4 paths, with holes filled and further refinement",
        Paper => "The paper's method: block matching without checks",
    }
    Interpolation {
        None => "Whole pixels, no interpolation",
        Parabola => "Vertex of a parabola through three costs",
        Equiangular => "Intersection of two lines of opposite slope through three costs",
    }
    Compared {
        Luma => "Luma, after equalisation",
        SoftRank => "How much brighter than a pixel its neighbours are, within limits",
    }
    View {
        Left => "",
        Right => "",
    }
}

impl Value for PathCount {
    fn kind() -> Kind {
        let help = |paths| match paths {
            Paths::Three => "Along rows in both directions, along columns downwards",
            Paths::Four => "Along rows and columns in both directions",
            Paths::Eight => "Along rows, columns and diagonals in both directions",
        };
        let none = Choice { name: "0", help: "No paths" };
        let some = Paths::ALL.map(|paths| Choice { name: paths.name(), help: help(paths) });
        Kind::Choice([none].into_iter().chain(some).collect())
    }

    fn read(text: &str) -> Result<Self, String> {
        match (text, Self::kind()) {
            ("0", _) => Ok(Self(None)),
            (_, Kind::Choice(choices)) => chosen(text, &choices).map(|paths| Self(Some(paths))),
            _ => Err(String::new()),
        }
    }
}
