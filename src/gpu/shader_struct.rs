//! Structs that a shader declares too: their members, for a test that compares both declarations.

/// The WGSL type of a value in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A scalar of this WGSL type.
    Scalar(&'static str),
    /// An array of so many elements, or a WGSL vector.
    Array(u64, &'static Shape),
    /// A struct: its size in bytes and its members.
    Struct(u64, &'static [Member]),
}

/// A member of a struct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name of the member, the same in WGSL and in Rust.
    pub name: &'static str,
    /// Offset from the beginning of the struct, in bytes.
    pub offset: u64,
    /// Type of the member.
    pub shape: Shape,
}

/// A Rust type with an equivalent in WGSL.
pub trait ShaderType {
    /// The WGSL type.
    const SHAPE: Shape;
}

impl ShaderType for u32 {
    const SHAPE: Shape = Shape::Scalar("u32");
}

impl ShaderType for i32 {
    const SHAPE: Shape = Shape::Scalar("i32");
}

impl ShaderType for f32 {
    const SHAPE: Shape = Shape::Scalar("f32");
}

impl<T: ShaderType, const N: usize> ShaderType for [T; N] {
    const SHAPE: Shape = Shape::Array(N as u64, &T::SHAPE);
}

/// Declares a struct that a shader declares with the same members in the same order.
macro_rules! shader_struct {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $name:ident {
            $($(#[$member_attribute:meta])* $member_visibility:vis $member:ident: $type:ty,)+
        }
    ) => {
        $(#[$attribute])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        $visibility struct $name {
            $($(#[$member_attribute])* $member_visibility $member: $type,)+
        }

        impl $crate::gpu::ShaderType for $name {
            const SHAPE: $crate::gpu::Shape = $crate::gpu::Shape::Struct(
                size_of::<$name>() as u64,
                &[$($crate::gpu::Member {
                    name: stringify!($member),
                    offset: std::mem::offset_of!($name, $member) as u64,
                    shape: <$type as $crate::gpu::ShaderType>::SHAPE,
                },)+],
            );
        }
    };
}

pub(crate) use shader_struct;
