//! Stores to storage buffers, which lavapipe does thread by thread, and how the values are kept out of that.
//!
//! A value is a vector with one element per thread, and a store to a buffer is a loop over its elements. LLVM moves the last
//! operations of the value into the loop, where it takes one element of each operand (`scalarizeExtract` in InstCombine,
//! LLVM 15, for operations with a constant): each turn of the loop then writes several vectors to memory to take an element
//! of each. A kernel that does little but store takes three times as long.
//!
//! The remedy: what is stored is the smaller of the value and a limit, which is the largest `u32`, but not known to the
//! compiler. A minimum stays a vector operation.

/// The `module` that stores whole values, and the first statement of its `main`, which sets their limit. Buffers that are
/// written are declared on one line each, as `@group(0) @binding(1) var<storage, read_write> words: array<u32>;`, of `u32`,
/// `i32`, `vec2<u32>` or `vec4<u32>`; others, atomics among them, stay as they are. A store is a statement that begins on its own line.
pub(super) fn with_whole_values(module: &str) -> (String, String) {
    let buffers: Vec<_> = module.lines().filter_map(written).collect();
    let mut text = String::with_capacity(module.len() + 1024);
    let mut rest = module;
    let mut is_stored = false;
    while let Some((start, function)) = next_store(rest, &buffers) {
        let end = start + rest[start..].find(';').expect("the end of a statement");
        text += &format!("{}{function}({})", &rest[..start], &rest[start..end]);
        rest = &rest[end..];
        is_stored = true;
    }
    text += rest;
    if !is_stored {
        return (text, String::new());
    }
    text += FUNCTIONS;
    (text, "    no_limit = select(0xffffffffu, 0u, dispatched.x == 0u);\n".into())
}

const FUNCTIONS: &str = "
var<private> no_limit: u32;

fn whole_u32(value: u32) -> u32 {
    return min(value, no_limit);
}

fn whole_i32(value: i32) -> i32 {
    return bitcast<i32>(min(bitcast<u32>(value), no_limit));
}

fn whole_vec2(value: vec2<u32>) -> vec2<u32> {
    return min(value, vec2<u32>(no_limit));
}

fn whole_vec4(value: vec4<u32>) -> vec4<u32> {
    return min(value, vec4<u32>(no_limit));
}
";

/// The name of the buffer that `line` declares, and the function for values that are stored to it.
fn written(line: &str) -> Option<(&str, &'static str)> {
    let (_, declaration) = line.split_once(" var<storage, read_write> ")?;
    let (name, elements) = declaration.split_once(": ")?;
    match elements {
        "array<u32>;" => Some((name, "whole_u32")),
        "array<i32>;" => Some((name, "whole_i32")),
        "array<vec2<u32>>;" => Some((name, "whole_vec2")),
        "array<vec4<u32>>;" => Some((name, "whole_vec4")),
        _ => None,
    }
}

/// The place in `text` of the value of the next store to one of `buffers`, and the function for it.
fn next_store(text: &str, buffers: &[(&str, &'static str)]) -> Option<(usize, &'static str)> {
    let mut place = 0;
    for line in text.split_inclusive('\n') {
        let statement = line.trim_start();
        let store = buffers.iter().find_map(|(name, function)| {
            let index = statement.strip_prefix(name)?.strip_prefix('[')?;
            let value = index[index_length(index)..].strip_prefix("] = ")?;
            Some((place + line.len() - value.len(), *function))
        });
        if store.is_some() {
            return store;
        }
        place += line.len();
    }
    None
}

/// The length of the index at the start of `text`, up to its closing bracket.
fn index_length(text: &str) -> usize {
    let mut depth = 0;
    for (place, character) in text.char_indices() {
        match character {
            '[' => depth += 1,
            ']' if depth == 0 => return place,
            ']' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_wrapped() {
        let module = "@group(0) @binding(0) var<storage, read_write> a: array<u32>;\n\
                      @group(0) @binding(1) var<storage, read_write> b: array<i32>;\n\
                      @group(0) @binding(2) var<storage, read> c: array<u32>;\n\
                      fn main() {\n    a[c[0] + 1u] = a[2] |\n        c[3];\n    if c[0] == 1u {\n        b[0] = 7;\n    }\n    \
                      ab[0] = a[0];\n}\n";
        let (text, limit) = with_whole_values(module);
        for line in ["a[c[0] + 1u] = whole_u32(a[2] |\n        c[3]);\n", " b[0] = whole_i32(7);\n", " ab[0] = a[0];\n"]
        {
            assert!(text.contains(line), "{line} in {text}");
        }
        assert!(limit.contains("no_limit"));
    }

    #[test]
    fn vectors_are_wrapped() {
        let module = "@group(0) @binding(0) var<storage, read_write> a: array<vec2<u32>>;\n\
                      @group(0) @binding(1) var<storage, read_write> b: array<vec4<u32>>;\n\
                      fn main() {\n    a[0] = v.xy;\n    b[1] = v;\n}\n";
        let (text, _) = with_whole_values(module);
        assert!(text.contains(" a[0] = whole_vec2(v.xy);\n    b[1] = whole_vec4(v);\n"), "{text}");
    }

    #[test]
    fn other_buffers_stay() {
        let module = "@group(0) @binding(0) var<storage, read_write> a: array<vec3<u32>>;\n\
                      @group(0) @binding(1) var<storage, read_write> b: array<atomic<u32>>;\n\
                      fn main() {\n    a[0] = vec3<u32>(1u);\n    atomicStore(&b[0], 1u);\n}\n";
        assert_eq!(with_whole_values(module), (module.to_string(), String::new()));
    }
}
