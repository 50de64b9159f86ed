//! Nested values of YAML, JSON and XML files.

use std::path::Path;

use crate::{
    error::{Error, Result},
    image::Size,
    io::malformed,
};

/// Deepest nesting: calibrations have four levels.
pub(super) const MAX_DEPTH: usize = 16;
/// Most values of a file: a matrix has 16 numbers.
pub(super) const MAX_NODES: usize = 1 << 16;
/// Most numbers of one entry.
const MAX_NUMBERS: usize = 64;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Text(String),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

/// A value with its name and file, for messages.
#[derive(Clone)]
pub(super) struct Field<'a> {
    node: &'a Node,
    name: String,
    path: &'a Path,
}

impl<'a> Field<'a> {
    pub fn root(node: &'a Node, path: &'a Path) -> Self {
        Self { node, name: String::new(), path }
    }

    /// The file that the value stands in.
    pub fn path(&self) -> &'a Path {
        self.path
    }

    /// The entry with one of several names that programs use.
    pub fn get(&self, keys: &[&str]) -> Option<Self> {
        let Node::Map(entries) = self.node else { return None };
        let named = |key: &&str| entries.iter().find(|(name, _)| name == *key);
        keys.iter().find_map(named).map(|(name, node)| Self { node, name: self.joined(name), path: self.path })
    }

    pub fn has(&self, keys: &[&str]) -> bool {
        self.get(keys).is_some()
    }

    /// As [`Self::get`]; `way_out` follows in the message for a missing entry.
    pub fn required(&self, keys: &[&str], way_out: &str) -> Result<Self> {
        self.get(keys).ok_or_else(|| {
            let name = self.joined(keys.first().unwrap_or(&""));
            malformed(self.path, format!("there is no {name}: {way_out}"))
        })
    }

    pub fn text(&self) -> Result<&'a str> {
        match self.node {
            Node::Text(text) => Ok(text.trim()),
            _ => Err(self.wrong("one value")),
        }
    }

    /// All numbers of a text, a list, a list of lists, or the `data` of a matrix, in order.
    pub fn numbers(&self) -> Result<Vec<f64>> {
        if let Some(data) = self.get(&["data"]) {
            return data.numbers();
        }
        let mut numbers = Vec::new();
        self.collect(self.node, &mut numbers)?;
        Ok(numbers)
    }

    /// Exactly `N` numbers.
    pub fn array<const N: usize>(&self) -> Result<[f64; N]> {
        let numbers = self.numbers()?;
        let found = numbers.len();
        numbers.try_into().map_err(|_| self.wrong(&format!("{N} numbers, and there are {found}")))
    }

    pub fn number(&self) -> Result<f64> {
        self.array().map(|[number]| number)
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> Result<Size> {
        let [width, height] = self.array()?;
        Ok(Size::new(self.whole(width)?, self.whole(height)?))
    }

    pub fn side(&self) -> Result<u32> {
        self.whole(self.number()?)
    }

    /// The error for a value that is not as `rule` says.
    pub fn wrong(&self, rule: &str) -> Error {
        let shown = match self.node {
            Node::Text(text) => format!("'{}'", text.trim().chars().take(60).collect::<String>()),
            Node::List(_) => "a list".into(),
            Node::Map(_) => "a group".into(),
        };
        let name = if self.name.is_empty() { "the file" } else { &self.name };
        malformed(self.path, format!("{name} is {shown}, but it must be {rule}"))
    }

    /// The error `error`, in this entry.
    pub fn refused(&self, error: Error) -> Error {
        match error {
            Error::Parameter { .. } if self.name.is_empty() => malformed(self.path, error.to_string()),
            Error::Parameter { .. } => malformed(self.path, format!("{}: {error}", self.name)),
            other => other,
        }
    }

    fn whole(&self, number: f64) -> Result<u32> {
        let is_side = number >= 1.0 && number <= f64::from(crate::luma::MAX_SIDE) && number.fract() == 0.0;
        if is_side { Ok(number as u32) } else { Err(self.wrong("a number of pixels from 1 on")) }
    }

    fn joined(&self, name: &str) -> String {
        if self.name.is_empty() { name.into() } else { format!("{}.{name}", self.name) }
    }

    fn collect(&self, node: &Node, numbers: &mut Vec<f64>) -> Result<()> {
        match node {
            Node::Text(text) => {
                for word in words(text) {
                    numbers.push(finite(word).ok_or_else(|| self.wrong_word(word))?);
                    if numbers.len() > MAX_NUMBERS {
                        return Err(self.wrong(&format!("at most {MAX_NUMBERS} numbers")));
                    }
                }
                Ok(())
            }
            Node::List(items) => items.iter().try_for_each(|item| self.collect(item, numbers)),
            Node::Map(_) => Err(self.wrong("numbers, or a matrix with its data")),
        }
    }

    fn wrong_word(&self, word: &str) -> Error {
        let word: String = word.chars().take(40).collect();
        malformed(self.path, format!("{} has '{word}', but all its values must be finite numbers", self.name))
    }
}

/// The words of a text, separated by white space and commas.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty())
}

/// Parses a finite number.
pub(super) fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}
