//! Inlinable uniforms, which lavapipe puts into a kernel's code, and how kernels are kept free of them.
//!
//! Where uniforms alone decide a branch or the length of a loop, lavapipe compiles the kernel again at each dispatch, with
//! the values of these uniforms in place of loads, and keeps every result. It gives this up for a kernel that hardly
//! shrinks, but the difference of sizes is unsigned (`update_inline_shader_state` in Mesa 22.3): where constants make the
//! kernel longer, as a width of 256 that turns multiplications into shifts, lavapipe compiles at each dispatch: up to half
//! a second and 14 MB per frame.
//!
//! The remedy is one for all kernels and all values. `main` copies each uniform buffer to a private variable, which
//! everything else reads, and overwrites the copy with zeros in a dispatch of no workgroups. No thread ever runs in such a
//! dispatch, but lavapipe does not know that: each value is a choice between a uniform and zero, so that no expression
//! consists of uniforms and constants alone. The choice is the same in all threads: control flow remains uniform.
//!
//! A storage buffer in place of the uniform buffer would do as well, but devices guarantee four storage buffers per stage,
//! and some stages have four. Other drivers keep uniforms in scalar registers, and get the module as it is.

/// The head of the entry point of every shader, without parameters.
const MAIN: &str = "\nfn main(";

/// The whole WGSL `module` without inlinable uniforms. Uniform buffers are declared on one line each, as
/// `@group(0) @binding(0) var<uniform> params: Params;`.
///
/// # Panics
/// If the module has another form: all shaders are ours, and a test covers them.
pub(super) fn without_inlinable_uniforms(module: &str) -> String {
    let mut text = String::with_capacity(module.len() + 1024);
    let mut copies = String::new();
    for line in module.split_inclusive('\n') {
        let Some((attributes, declaration)) = line.split_once(" var<uniform> ") else {
            text += line;
            continue;
        };
        let parts = declaration.trim_end().strip_suffix(';').and_then(|declaration| declaration.split_once(": "));
        let (name, shape) = parts.unwrap_or_else(|| panic!("not a uniform on one line: {line}"));
        text += &format!("{attributes} var<uniform> bound_{name}: {shape};\nvar<private> {name}: {shape};\n");
        copies +=
            &format!("    {name} = bound_{name};\n    if dispatched.x == 0u {{\n        {name} = {shape}();\n    }}\n");
    }
    if copies.is_empty() {
        return text;
    }
    let head = text.find(MAIN).expect("an entry point main") + MAIN.len();
    let body = head + text[head..].find("{\n").expect("a body") + 2;
    text.insert_str(body, &copies);
    text.insert_str(head, "@builtin(num_workgroups) dispatched: vec3<u32>, ");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn main_copies_uniforms_before_anything_reads_them() {
        let module = "struct P {\n    n: u32,\n}\n@group(0) @binding(0) var<uniform> p: P;\n\n@compute @workgroup_size(1)\n\
                      fn main(@builtin(workgroup_id) id: vec3<u32>) {\n    f(p.n);\n}\n";
        let copied = "struct P {\n    n: u32,\n}\n@group(0) @binding(0) var<uniform> bound_p: P;\nvar<private> p: P;\n\n\
                      @compute @workgroup_size(1)\n\
                      fn main(@builtin(num_workgroups) dispatched: vec3<u32>, @builtin(workgroup_id) id: vec3<u32>) {\n    \
                      p = bound_p;\n    if dispatched.x == 0u {\n        p = P();\n    }\n    f(p.n);\n}\n";
        assert_eq!(without_inlinable_uniforms(module), copied);
    }

    #[test]
    fn a_module_without_uniforms_stays() {
        let module = "@compute @workgroup_size(1)\nfn main() {\n}\n";
        assert_eq!(without_inlinable_uniforms(module), module);
    }

    #[test]
    #[should_panic(expected = "not a uniform on one line")]
    fn a_uniform_on_two_lines_is_a_mistake() {
        without_inlinable_uniforms("@group(0) @binding(0) var<uniform> p:\n    P;\n");
    }
}
