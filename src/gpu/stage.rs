//! A stage: WGSL text, its bindings, and the constants that host and shader share.

use super::{imports::imported, shader_struct::Shape, unroll::unrolled};

/// One binding of a kernel's only bind group, in the order of `@binding`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A uniform buffer that holds this.
    Uniform(Shape),
    /// A storage buffer that is only read.
    Read,
    /// A storage buffer that is written.
    Write,
    /// A storage texture of one `u32` a texel that is only read.
    Words,
    /// A texture of floats that is only read, and not sampled.
    Picture,
    /// A texture of this format that is only written.
    Map(wgpu::TextureFormat),
}

/// What a stage's kernel is made of; enough to build it, and to check it without any GPU.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The stage's name: that of its shader, its Rust file, its CPU twin and its test.
    pub name: &'static str,
    /// The shader's text, without its constants and its imports.
    pub source: &'static str,
    /// The buffers of bind group 0, in order.
    pub bindings: &'static [Binding],
    /// Constants that host and shader share; written in front of the text.
    pub constants: Vec<(&'static str, i64)>,
}

impl Stage {
    /// The whole module: the constants, the imported parts, the shader's text, with marked loops unrolled.
    pub fn wgsl(&self) -> String {
        let mut text = String::new();
        for (name, value) in &self.constants {
            text += &format!("const {name} = {value};\n");
        }
        text + &unrolled(&imported(self.source), &self.constants)
    }
}
