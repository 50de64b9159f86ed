//! Changes of the second view before matching: the values of `--condition`.

use hsad::{
    Result,
    eval::conditions::{Condition, Kind},
};

/// The condition that leaves the view unchanged.
const NONE: &str = "none";

/// A chain of conditions, applied in order, and its name.
#[derive(Clone)]
pub struct Change {
    pub name: String,
    pub conditions: Vec<Condition>,
}

impl Change {
    /// Whether the change moves points, so that rows of a rectified pair do not correspond any more.
    pub fn moves(&self) -> bool {
        self.conditions.iter().copied().any(Condition::moves)
    }

    /// Parses `NAME`, `NAME=STRENGTH`, several of these joined by `+`, or `none`.
    ///
    /// # Errors
    /// [`hsad::Error::Parameter`] for an unknown name or a strength outside its range.
    pub fn parse(text: &str) -> Result<Self> {
        let named = text.split('+').filter(|&part| part != NONE);
        let conditions: Vec<Condition> = named.map(str::parse).collect::<Result<_>>()?;
        let names: Vec<String> = conditions.iter().map(Condition::to_string).collect();
        Ok(Self { name: if names.is_empty() { NONE.into() } else { names.join("+") }, conditions })
    }

    /// Parses several changes, without duplicates.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn parse_all(texts: &[String]) -> Result<Vec<Self>> {
        let mut changes: Vec<Self> = Vec::new();
        for text in texts {
            let change = Self::parse(text)?;
            if changes.iter().all(|known| known.name != change.name) {
                changes.push(change);
            }
        }
        Ok(changes)
    }
}

/// Help text: one line for each kind of condition.
pub fn kinds() -> String {
    let lines = Kind::ALL.map(|kind| {
        let [least, greatest] = kind.range();
        let (name, usual, neutral) = (kind.name(), kind.usual(), kind.neutral());
        format!("  {name:<11}{least} to {greatest}; {neutral} changes nothing [default: {usual}]")
    });
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        for (text, name) in [
            ("none", "none"),
            ("none+none", "none"),
            ("rotation+none", "rotation=30"),
            ("noise=3+blur=1.50", "noise=3+blur=1.5"),
        ] {
            assert_eq!(Change::parse(text).unwrap().name, name);
        }
        for text in ["", "noise+", "fog"] {
            assert!(Change::parse(text).is_err(), "{text}");
        }
        let all = ["none", "noise=10", "noise", "none+none"].map(String::from);
        assert_eq!(Change::parse_all(&all).unwrap().len(), 2);
    }
}
