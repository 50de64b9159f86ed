//! The WGSL of kernels for lavapipe, whose compiler makes slow code of two things that other compilers take as they are:
//! uniforms that decide branches ([`uniforms`]), and stores to buffers ([`stores`]).
//!
//! Both remedies are values that lavapipe cannot foresee. They are chosen by the number of workgroups of the dispatch,
//! `dispatched`: a dispatch of no workgroups would choose others, but then no thread runs.

mod stores;
mod uniforms;

/// The head of the entry point of every shader, without parameters.
const MAIN: &str = "\nfn main(";

/// The whole WGSL `module` for lavapipe.
///
/// # Panics
/// If the module is not written as [`uniforms`] and [`stores`] expect: all shaders are ours, and a test covers them.
pub(super) fn for_lavapipe(module: &str) -> String {
    let (text, copies) = uniforms::copied(module);
    let (mut text, limit) = stores::with_whole_values(&text);
    let first_statements = copies + &limit;
    if first_statements.is_empty() {
        return text;
    }
    let head = text.find(MAIN).expect("an entry point main") + MAIN.len();
    let body = head + text[head..].find("{\n").expect("a body") + 2;
    text.insert_str(body, &first_statements);
    text.insert_str(head, "@builtin(num_workgroups) dispatched: vec3<u32>, ");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn main_chooses_before_anything_reads() {
        let module = "struct P {\n    n: u32,\n}\n@group(0) @binding(0) var<uniform> p: P;\n\n@compute @workgroup_size(1)\n\
                      fn main(@builtin(workgroup_id) id: vec3<u32>) {\n    f(p.n);\n}\n";
        let copied = "struct P {\n    n: u32,\n}\n@group(0) @binding(0) var<uniform> bound_p: P;\nvar<private> p: P;\n\n\
                      @compute @workgroup_size(1)\n\
                      fn main(@builtin(num_workgroups) dispatched: vec3<u32>, @builtin(workgroup_id) id: vec3<u32>) {\n    \
                      p = bound_p;\n    if dispatched.x == 0u {\n        p = P();\n    }\n    f(p.n);\n}\n";
        assert_eq!(for_lavapipe(module), copied);
    }

    #[test]
    fn a_module_without_uniforms_and_stores_stays() {
        let module = "@compute @workgroup_size(1)\nfn main() {\n}\n";
        assert_eq!(for_lavapipe(module), module);
    }
}
