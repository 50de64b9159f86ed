//! The errors of this crate. Each message has the value, the limit and the way out.

use std::path::{Path, PathBuf};

use crate::size::Size;

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// A path in a message: characters that would break its line, or that terminals obey, are escaped as in Rust's strings.
#[doc(hidden)]
pub fn shown(path: &Path) -> String {
    let mut text = String::new();
    for letter in path.to_string_lossy().chars() {
        // Marks that turn the direction of writing are no control characters by their class.
        if letter.is_control()
            || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
        {
            text.extend(letter.escape_default());
        } else {
            text.push(letter);
        }
    }
    text
}

/// The reason why a call failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The two views do not have the same size.
    #[error(
        "the left view is {left} and the right view {right} pixels: a rectified pair has one size, scale or crop one of them"
    )]
    SizesDiffer {
        /// Size of the left view.
        left: Size,
        /// Size of the right view.
        right: Size,
    },

    /// The picture is too small for a window or filter.
    #[error("a picture of {size} pixels is too small for {what}: {way_out}")]
    TooSmall {
        /// Size of the picture.
        size: Size,
        /// The window or filter.
        what: String,
        /// The way out.
        way_out: String,
    },

    /// A buffer would exceed the limits of the device, or the limit up to which results are equal on every device and the
    /// CPU.
    #[error("{what} needs {needed} bytes in one buffer, and there can be at most {limit}: {way_out}")]
    TooLarge {
        /// The use of the buffer.
        what: String,
        /// Size that is needed, in bytes.
        needed: u64,
        /// Largest possible size, in bytes.
        limit: u64,
        /// The way out.
        way_out: String,
    },

    /// The memory of the host does not suffice; told before the work begins.
    #[error("{what} needs {} MiB of memory, and {by} leaves {} MiB: {way_out}", needed.div_ceil(1 << 20), available >> 20)]
    NotEnoughMemory {
        /// The work.
        what: String,
        /// Memory that is needed, in bytes.
        needed: u64,
        /// Memory that is left, in bytes.
        available: u64,
        /// What limits the memory: the machine, a container, or a limit of the process.
        by: &'static str,
        /// The way out.
        way_out: String,
    },

    /// A parameter lies outside its range.
    #[error("{name} is {value}, but {expected}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// The value.
        value: String,
        /// The accepted values.
        expected: String,
    },

    /// A buffer, texture or view of the application has the wrong size, format, usage or dimension.
    #[error("{name} is {value}, but {expected}")]
    Resource {
        /// Role of the buffer, texture or view.
        name: &'static str,
        /// Its property that is wrong.
        value: String,
        /// The accepted values.
        expected: String,
    },

    /// The picture has more interest points than the capacity of the list, which was read without a chance to keep the
    /// strongest: see [`crate::Detector::detect`].
    #[error(
        "max_features is {room}, but the picture has {found} interest points: raise max_features, or raise the threshold"
    )]
    TooManyFeatures {
        /// Number of interest points of the picture.
        found: usize,
        /// Capacity of the list: [`crate::FeatureConfig::max_features`].
        room: u32,
    },

    /// The rows of the views do not correspond: a search along rows would find noise.
    #[error("the pair is not rectified: {diagnosis}; rectify both views first, or search along rows all the same")]
    NotRectified {
        /// How rows differ.
        diagnosis: String,
    },

    /// No warp brings the rows of the views to correspond.
    #[error("the pair cannot be rectified: {reason}")]
    NotRectifiable {
        /// How the cameras stand or what the views show, and what to do about it.
        reason: String,
    },

    /// No disparity range: too few matches, or a range below [`crate::Config::least`].
    #[error("the disparity range could not be found: {reason}; name the range to search")]
    NoRange {
        /// Numbers of matches, or the range.
        reason: String,
    },

    /// No adapter.
    #[error(
        "no GPU adapter was found: install a Vulkan driver (Debian and Ubuntu: apt-get install mesa-vulkan-drivers, \
         a driver that needs no GPU)"
    )]
    NoAdapter,

    /// No adapter with the requested name or index.
    #[error("no device matches '{wanted}'; there are: {available}")]
    NoSuchDevice {
        /// The requested name or index.
        wanted: String,
        /// Names of all adapters.
        available: String,
    },

    /// The device lacks a limit or feature, or refuses a resource.
    #[error("the device cannot run this: {0}")]
    Unsupported(String),

    /// Results of the device differ from those of the CPU twins.
    #[error(
        "{device} computes wrong results ({what}): use another device or the CPU, and repeat the failure with {command}"
    )]
    WrongResults {
        /// Name of the device.
        device: String,
        /// The kernel, and its first difference.
        what: String,
        /// A command that repeats the failure.
        command: String,
    },

    /// The device ran out of memory.
    #[error("the device ran out of memory for {0}: use a smaller picture or another device")]
    OutOfMemory(String),

    /// The device was lost and must be opened again.
    #[error("the device was lost ({0}): open it again")]
    DeviceLost(String),

    /// A file could not be read or written.
    #[error("{}: {source}", shown(path))]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },

    /// The content of a file contradicts its format.
    #[error("{}: {reason}", shown(path))]
    Format {
        /// The file.
        path: PathBuf,
        /// The contradiction, and the accepted content.
        reason: String,
    },
}

/// Refuses a parameter unless `holds`.
pub(crate) fn check(
    holds: bool,
    name: &'static str,
    value: impl std::fmt::Display,
    expected: impl Into<String>,
) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::Parameter { name, value: value.to_string(), expected: expected.into() }) }
}

/// Refuses a parameter outside `range`.
pub(crate) fn check_range<T: PartialOrd + std::fmt::Display>(
    name: &'static str,
    value: T,
    range: std::ops::RangeInclusive<T>,
) -> Result<()> {
    check(range.contains(&value), name, &value, format!("it must be {} to {}", range.start(), range.end()))
}
