//! Unrolls marked loops before compilation.
//!
//! Shader compilers differ in where they keep a small array that is indexed by a loop counter: some in registers, some
//! in memory, at forty times the cost (Mesa 22). In an unrolled loop every index is a constant, and every compiler
//! keeps the array in registers. Shaders stay readable and valid WGSL, since loops stay loops in the file, marked for
//! this pass:
//!
//! ```wgsl
//! for (var y = 0; y < ROWS + 1; y++) { // unroll
//!     sum += column[y];
//! }
//! ```
//!
//! Each iteration becomes a block of its own, with the counter's value in place of the counter's name. Unroll in small
//! functions only: the time that naga 30 takes is quadratic in the length of a function.

/// Unrolls every marked loop of `source`; the bounds of loops are sums of numbers and of `constants`.
///
/// # Panics
/// If a marked loop does not have exactly the form above: all shaders are ours, and a test covers them.
pub(crate) fn unrolled(source: &str, constants: &[(&str, i64)]) -> String {
    let mut out = String::with_capacity(source.len());
    let mut rest = source;
    while let Some((line, after)) = split_line(rest) {
        let Some(head) = line.trim_end().strip_suffix("{ // unroll") else {
            out.push_str(line);
            rest = after;
            continue;
        };
        let indent = &line[..line.len() - line.trim_start().len()];
        let length = body_length(after, indent).unwrap_or_else(|| panic!("no end of the loop: {line}"));
        let (counter, bound) = parse_head(head.trim());
        // Inner loops first: each is unrolled once, not once per copy of the outer loop's body.
        let body = unrolled(&after[..length], constants);
        for iteration in 0..evaluate(bound, constants) {
            out.push_str(indent);
            out.push_str("{\n");
            substitute(&body, counter, &iteration.to_string(), &mut out);
            out.push_str(indent);
            out.push_str("}\n");
        }
        rest = split_line(&after[length..]).map_or("", |(_, rest)| rest);
    }
    out
}

/// The length of the loop body at the start of `text`: up to the line with the closing brace at `indent`.
fn body_length(text: &str, indent: &str) -> Option<usize> {
    let mut length = 0;
    for line in text.split_inclusive('\n') {
        if line.strip_prefix(indent).is_some_and(|line| line.starts_with('}')) {
            return Some(length);
        }
        length += line.len();
    }
    None
}

/// The first line with its line break, and the rest.
fn split_line(text: &str) -> Option<(&str, &str)> {
    let end = text.find('\n').map_or(text.len(), |end| end + 1);
    (end > 0).then(|| text.split_at(end))
}

/// Appends `body` with each whole word `counter` replaced.
fn substitute(body: &str, counter: &str, value: &str, out: &mut String) {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut rest = body;
    while let Some(start) = rest.find(counter) {
        let (before, after) = (&rest[..start], &rest[start + counter.len()..]);
        let is_counter = !before.ends_with(part_of_word) && !after.starts_with(part_of_word);
        out.push_str(before);
        out.push_str(if is_counter { value } else { counter });
        rest = after;
    }
    out.push_str(rest);
}

/// The counter and the bound of `for (var i = 0; i < BOUND; i++)`.
fn parse_head(head: &str) -> (&str, &str) {
    let parse = || {
        let inner = head.strip_prefix("for (var ")?.strip_suffix("++)")?;
        let (counter, inner) = inner.split_once(" = 0; ")?;
        let bound = inner.strip_prefix(counter)?.strip_prefix(" < ")?.strip_suffix(counter)?.strip_suffix("; ")?;
        Some((counter, bound))
    };
    parse().unwrap_or_else(|| panic!("not a loop that can be unrolled: {head}"))
}

/// The value of a sum of numbers and constants.
fn evaluate(sum: &str, constants: &[(&str, i64)]) -> i64 {
    let value = |term: &str| {
        let constant = constants.iter().find(|(name, _)| *name == term).map(|&(_, value)| value);
        constant.or_else(|| term.parse().ok()).unwrap_or_else(|| panic!("no constant {term}"))
    };
    sum.split('+').map(|term| value(term.trim())).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_loops_become_blocks_in_order() {
        let source = "a\n  for (var i = 0; i < N + 1; i++) { // unroll\n    for (var j = 0; j < 2; j++) { // unroll\n      f(i, j);\n    }\n  }\nb\n";
        let calls: Vec<String> = unrolled(source, &[("N", 1)]).lines().map(|l| l.trim().to_owned()).collect();
        let expected = [
            "a", "{", "{", "f(0, 0);", "}", "{", "f(0, 1);", "}", "}", "{", "{", "f(1, 0);", "}", "{", "f(1, 1);", "}",
            "}", "b",
        ];
        assert_eq!(calls, expected);
    }

    #[test]
    fn only_whole_words_are_the_counter() {
        let source = "for (var i = 0; i < 1; i++) { // unroll\n  i + id.x + x_i + if(i)\n}\n";
        assert_eq!(unrolled(source, &[]), "{\n  0 + id.x + x_i + if(0)\n}\n");
    }

    #[test]
    fn other_loops_stay() {
        let source = "for (var i = 0; i < n; i++) {\n}\n";
        assert_eq!(unrolled(source, &[]), source);
    }

    #[test]
    #[should_panic(expected = "no constant M")]
    fn an_unknown_bound_is_a_mistake() {
        unrolled("for (var i = 0; i < M; i++) { // unroll\n}\n", &[]);
    }
}
