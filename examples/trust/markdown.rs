//! Tables in Markdown.

/// Prints a heading.
pub fn heading(text: &str) {
    println!("\n## {text}\n");
}

/// Prints the first two lines of a table.
pub fn columns(names: &[&str]) {
    println!("| {} |\n|{}", names.join(" | "), "---|".repeat(names.len()));
}

/// Prints one line of a table.
pub fn row(cells: &[String]) {
    println!("| {} |", cells.join(" | "));
}

/// A share of 0 to 1 in per cent; a dash for NaN, the share of nothing.
pub fn percent(share: f64) -> String {
    if share.is_nan() { "-".into() } else { format!("{:.1}", 100.0 * share) }
}

/// The mean of shares that are not NaN; NaN without such shares.
pub fn mean(shares: impl IntoIterator<Item = f64>) -> f64 {
    let known: Vec<f64> = shares.into_iter().filter(|share| !share.is_nan()).collect();
    known.iter().sum::<f64>() / known.len() as f64
}
