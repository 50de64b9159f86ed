//! Loops written out before compilation.
//!
//! Shader compilers differ in what they make of a small array that is indexed by a loop counter:
//! some keep it in registers, some in memory, at forty times the cost (Mesa 22). With the loop
//! written out every index is a constant, and all of them keep it in registers. So that a shader
//! stays readable, and valid WGSL, its loops stay loops in the file, marked for this pass:
//!
//! ```wgsl
//! for (var y = 0; y < ROWS + 1; y++) { // unroll
//!     sum += column[y];
//! }
//! ```
//!
//! Each turn becomes a block of its own, in which the counter is a `const`.

/// `source` with every marked loop written out; bounds are sums of numbers and of `constants`.
///
/// # Panics
/// If a marked loop does not have exactly the form above: the shaders are ours, and a test goes
/// through all of them.
pub(crate) fn unrolled(source: &str, constants: &[(&str, i64)]) -> String {
    let lines: Vec<&str> = source.lines().collect();
    let mut out = String::with_capacity(source.len());
    write_out(&lines, constants, &mut out);
    out
}

fn write_out(lines: &[&str], constants: &[(&str, i64)], out: &mut String) {
    let mut rest = lines;
    while let Some((line, after)) = rest.split_first() {
        let Some(head) = line.trim_end().strip_suffix("{ // unroll") else {
            out.push_str(line);
            out.push('\n');
            rest = after;
            continue;
        };
        let indent = &line[..line.len() - line.trim_start().len()];
        let length = after
            .iter()
            .position(|l| l.strip_prefix(indent).is_some_and(|l| l.starts_with('}')))
            .unwrap_or_else(|| panic!("no end of the loop: {line}"));
        let (counter, bound) = parse_head(head.trim());
        for turn in 0..evaluate(bound, constants) {
            out.push_str(&format!("{indent}{{ const {counter} = {turn};\n"));
            write_out(&after[..length], constants, out);
            out.push_str(indent);
            out.push_str("}\n");
        }
        rest = &after[length + 1..];
    }
}

/// The counter and the bound of `for (var i = 0; i < BOUND; i++)`.
fn parse_head(head: &str) -> (&str, &str) {
    let parse = || {
        let inner = head.strip_prefix("for (var ")?.strip_suffix("++)")?;
        let (counter, inner) = inner.split_once(" = 0; ")?;
        let bound = inner.strip_prefix(counter)?.strip_prefix(" < ")?.strip_suffix(counter)?.strip_suffix("; ")?;
        Some((counter, bound))
    };
    parse().unwrap_or_else(|| panic!("not a loop that can be written out: {head}"))
}

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
            "a",
            "{ const i = 0;",
            "{ const j = 0;",
            "f(i, j);",
            "}",
            "{ const j = 1;",
            "f(i, j);",
            "}",
            "}",
            "{ const i = 1;",
            "{ const j = 0;",
            "f(i, j);",
            "}",
            "{ const j = 1;",
            "f(i, j);",
            "}",
            "}",
            "b",
        ];
        assert_eq!(calls, expected);
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
