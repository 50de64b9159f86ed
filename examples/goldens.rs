//! Computes the golden hashes from the CPU twins, writes them, and lists the changed ones:
//!
//!     cargo run --example goldens
//!
//! `git diff src/verify/goldens.txt` shows the changes afterwards.
#![allow(clippy::print_stdout, reason = "it is a command")]

use std::{collections::BTreeMap, error::Error, fs, path::Path};

use hsad::verify::goldens;

fn main() -> Result<(), Box<dyn Error>> {
    let (stored, current) = (goldens::text(), goldens::current()?);
    let (before, after) = (hashes(stored), hashes(&current));
    for (case, hash) in &after {
        match before.get(case) {
            None => println!("new      {case} {hash}"),
            Some(old) if old != hash => println!("changed  {case} {hash}, was {old}"),
            Some(_) => {}
        }
    }
    before.keys().filter(|case| !after.contains_key(*case)).for_each(|case| println!("gone     {case}"));
    fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/verify/goldens.txt"), &current)?;
    println!("{} cases, {}", after.len(), if stored == current { "nothing changed" } else { "written" });
    Ok(())
}

/// The hash of each case.
fn hashes(text: &str) -> BTreeMap<&str, &str> {
    text.lines().filter_map(|line| line.rsplit_once(' ')).collect()
}
