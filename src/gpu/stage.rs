//! A stage: WGSL text, its bindings, and the constants that host and shader share.

use super::{imports::imported, lavapipe::for_lavapipe, shader_struct::Shape, unroll::unrolled};

/// One binding of a kernel's only bind group, in the order of `@binding`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A uniform buffer of this type.
    Uniform(Shape),
    /// A read-only storage buffer.
    Read,
    /// A read-write storage buffer.
    Write,
    /// A read-only storage texture of one `u32` per texel.
    Words,
    /// A texture of floats that is loaded, never sampled.
    Picture,
    /// A write-only storage texture of this format.
    Map(wgpu::TextureFormat),
}

/// Source, bindings and constants of a stage: enough to compile its kernel, and to check it without a GPU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// Name of the stage, shared by its shader, its Rust file, its CPU twin and its test.
    pub name: &'static str,
    /// WGSL of the shader, without its constants and imports.
    pub source: &'static str,
    /// The buffers of bind group 0, in order.
    pub bindings: &'static [Binding],
    /// Constants that host and shader share, written in front of the WGSL.
    pub constants: Vec<(&'static str, i64)>,
}

impl Stage {
    /// The whole WGSL module: constants, imported parts, then the shader with its marked loops unrolled.
    pub fn wgsl(&self) -> String {
        let mut text = String::new();
        for (name, value) in &self.constants {
            text += &format!("const {name} = {value};\n");
        }
        text + &unrolled(&imported(self.source), &self.constants)
    }

    /// Threads per workgroup.
    ///
    /// # Panics
    /// If the shader names a side that is no constant: all shaders are ours, and a test covers them.
    pub fn workgroup(&self) -> u32 {
        let (_, sides) = self.source.split_once("@workgroup_size(").expect("a size of workgroups");
        let (sides, _) = sides.split_once(')').expect("the end of the size");
        let side = |side: &str| {
            let constant = self.constants.iter().find(|(name, _)| *name == side).map(|&(_, value)| value as u32);
            constant.or_else(|| side.parse().ok()).unwrap_or_else(|| panic!("{}: no constant {side}", self.name))
        };
        sides.split([',', '*']).map(|text| side(text.trim())).product()
    }

    /// [`Self::wgsl`] for lavapipe: see `src/gpu/lavapipe/`.
    pub fn wgsl_for_lavapipe(&self) -> String {
        for_lavapipe(&self.wgsl())
    }
}
