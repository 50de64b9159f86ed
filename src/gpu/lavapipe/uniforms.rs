//! Inlinable uniforms, which lavapipe puts into a kernel's code, and how kernels are kept free of them.
//!
//! Where uniforms alone decide a branch or the length of a loop, lavapipe compiles the kernel again at each dispatch, with
//! the values of these uniforms in place of loads, and keeps every result. It gives this up for a kernel that hardly
//! shrinks, but the difference of sizes is unsigned (`update_inline_shader_state` in Mesa 22.3): where constants make the
//! kernel longer, as a width of 256 that turns multiplications into shifts, lavapipe compiles at each dispatch: up to half
//! a second and 14 MB per frame.
//!
//! The remedy is one for all kernels and all values. `main` copies each uniform buffer to a private variable, which
//! everything else reads, and overwrites the copy with zeros in a dispatch of no workgroups. Each value is then a choice
//! between a uniform and zero, so that no expression consists of uniforms and constants alone. The choice is the same in
//! all threads: control flow remains uniform.
//!
//! A storage buffer in place of the uniform buffer would do as well, but devices guarantee four storage buffers per stage,
//! and some stages have four. Other drivers keep uniforms in scalar registers, and get the module as it is.

/// The `module` that reads copies of its uniforms, and the first statements of its `main`, which make the copies. Uniform
/// buffers are declared on one line each, as `@group(0) @binding(0) var<uniform> params: Params;`.
///
/// # Panics
/// If the module has another form.
pub(super) fn copied(module: &str) -> (String, String) {
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
    (text, copies)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "not a uniform on one line")]
    fn a_uniform_on_two_lines_is_a_mistake() {
        copied("@group(0) @binding(0) var<uniform> p:\n    P;\n");
    }
}
