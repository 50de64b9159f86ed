//! What happens to the second view before it is matched, as people name it.

use hsad::{
    Result,
    eval::conditions::{Condition, Kind},
};

/// What leaves the view as it is.
const NONE: &str = "none";

/// Changes in a row, and what they are called.
pub struct Change {
    pub name: String,
    pub conditions: Vec<Condition>,
}

impl Change {
    /// `NAME`, `NAME=STRENGTH`, several of these joined by `+`, or `none`.
    ///
    /// # Errors
    /// [`hsad::Error::Parameter`] for a name or a strength that there is not.
    pub fn parse(text: &str) -> Result<Self> {
        let named = text.split('+').filter(|&part| part != NONE);
        let conditions: Vec<Condition> = named.map(str::parse).collect::<Result<_>>()?;
        let names: Vec<String> = conditions.iter().map(Condition::to_string).collect();
        Ok(Self { name: if names.is_empty() { NONE.into() } else { names.join("+") }, conditions })
    }

    /// What is asked for, each once.
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

/// A line on each kind of condition, for help.
pub fn kinds() -> String {
    let lines = Kind::ALL.map(|kind| {
        let [least, greatest] = kind.range();
        let (name, usual, neutral) = (kind.name(), kind.usual(), kind.neutral());
        format!("  {name:<11}{least} to {greatest}; {neutral} changes nothing, {usual} if none is named")
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
