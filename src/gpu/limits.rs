//! Limits of wgpu that a device must have, independent of the size of pictures.

use super::Gpu;
use crate::{
    error::{Error, Result, check},
    image::Size,
};

/// A limit of [`wgpu::Limits`] that the kernels need.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// Name of the field of [`wgpu::Limits`].
    pub name: &'static str,
    /// Least accepted value.
    pub least: u64,
    /// Reads the limit from a device's limits.
    pub of: fn(&wgpu::Limits) -> u64,
}

/// A [`Limit`] by its name.
macro_rules! limit {
    ($name:ident, $least:expr) => {
        Limit { name: stringify!($name), least: $least, of: |limits| limits.$name.into() }
    };
}

/// The required limits; [`wgpu::Limits::downlevel_defaults`] has them all. No [`wgpu::Features`] are required. The
/// largest picture also depends on `max_buffer_size`, `max_storage_buffer_binding_size` and `max_texture_dimension_2d`.
pub const REQUIRED_LIMITS: &[Limit] = &[
    limit!(max_bind_groups, 1),
    limit!(max_bindings_per_bind_group, 7),
    limit!(max_uniform_buffers_per_shader_stage, 2),
    limit!(max_uniform_buffer_binding_size, 96),
    limit!(max_storage_buffers_per_shader_stage, 4),
    limit!(max_sampled_textures_per_shader_stage, 1),
    limit!(max_storage_textures_per_shader_stage, 2),
    limit!(max_texture_dimension_2d, 2048),
    limit!(max_compute_workgroup_storage_size, 6144),
    limit!(max_compute_invocations_per_workgroup, 256),
    limit!(max_compute_workgroup_size_x, 256),
    limit!(max_compute_workgroup_size_y, 16),
    limit!(max_compute_workgroup_size_z, 1),
    limit!(max_compute_workgroups_per_dimension, 65_535),
];

/// The most turns that all loops of a thread may take together. lavapipe ends every loop of a thread after 65,535
/// (`LP_MAX_TGSI_LOOP_ITERATIONS` in Mesa) without an error: what the thread had still to write stays as it was.
pub(crate) const MOST_TURNS: u32 = 65_000;

/// Checks that a loop over the pixels of a row or a column of a picture of `size` does not take too many turns on the device.
///
/// # Errors
/// [`Error::Parameter`] with the ways out.
pub(crate) fn check_turns(gpu: &Gpu, size: Size) -> Result<()> {
    let longest = size.width.max(size.height);
    let expected =
        format!("lavapipe follows lines of at most {MOST_TURNS} px: match the picture in tiles, or on another device");
    check(longest <= MOST_TURNS || !gpu.is_lavapipe(), "the longest side of the picture in pixels", longest, expected)
}

/// Names of the limits on the size of a storage buffer.
pub(crate) const BUFFER_LIMITS: &str = "max_storage_buffer_binding_size and max_buffer_size";

/// Checks the device against [`REQUIRED_LIMITS`], before anything is created on it.
///
/// # Errors
/// [`Error::Unsupported`] with the limit's name.
pub(crate) fn check_limits(gpu: &Gpu) -> Result<()> {
    let limits = gpu.device.limits();
    match REQUIRED_LIMITS.iter().find(|limit| (limit.of)(&limits) < limit.least) {
        None => Ok(()),
        Some(limit) => Err(Error::Unsupported(format!(
            "its limit {} is {}, but at least {} is needed: request it with wgpu::Limits::downlevel_defaults() or more",
            limit.name,
            (limit.of)(&limits),
            limit.least
        ))),
    }
}
