//! Everything that can go wrong, each with the value, the limit and the way out.

use std::path::PathBuf;

use crate::size::Size;

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a call could not do what it was asked.
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

    /// The picture has no use for the work asked of it, because of its size.
    #[error("a picture of {size} pixels is too small for {what}: {way_out}")]
    TooSmall {
        /// Size of the picture.
        size: Size,
        /// What was asked.
        what: String,
        /// What to do about it.
        way_out: String,
    },

    /// A buffer for this picture would be larger than the device can bind, or than results that are the same on every
    /// device and the CPU allow.
    #[error("{what} needs {needed} bytes in one buffer, and there can be at most {limit}: {way_out}")]
    TooLarge {
        /// What the memory is for.
        what: String,
        /// Bytes that are needed.
        needed: u64,
        /// Bytes that are possible.
        limit: u64,
        /// What to do about it.
        way_out: String,
    },

    /// A parameter lies outside its range.
    #[error("{name} is {value}, but {expected}")]
    Parameter {
        /// The parameter's name as its user writes it.
        name: &'static str,
        /// The value that was given.
        value: String,
        /// What would be accepted.
        expected: String,
    },

    /// A buffer or texture of the application cannot serve for its use.
    #[error("{name} is {value}, but {expected}")]
    Resource {
        /// What the buffer or texture was given as.
        name: &'static str,
        /// What was given.
        value: String,
        /// What would be accepted.
        expected: String,
    },

    /// The picture has more interest points than there is room for.
    #[error(
        "max_features is {room}, but the picture has {found} interest points: raise max_features, or raise the threshold"
    )]
    TooManyFeatures {
        /// Interest points in the picture.
        found: usize,
        /// Interest points that there is room for: [`crate::FeatureConfig::max_features`].
        room: u32,
    },

    /// The pair's rows do not correspond, so a search along rows would find nothing but noise.
    #[error("the pair is not rectified: {diagnosis}; rectify it first, or search along rows all the same")]
    NotRectified {
        /// The figures.
        diagnosis: String,
    },

    /// Too few points of one view were found in the other to tell the disparity range.
    #[error("the disparity range could not be found: {reason}; name the range to search")]
    NoRange {
        /// What was found instead.
        reason: String,
    },

    /// No adapter at all.
    #[error(
        "no GPU adapter was found: install a Vulkan driver (Debian and Ubuntu: apt-get install mesa-vulkan-drivers, \
         a driver that needs no GPU)"
    )]
    NoAdapter,

    /// No adapter of the name or index asked for.
    #[error("no device matches '{wanted}'; there are: {available}")]
    NoSuchDevice {
        /// What was asked for.
        wanted: String,
        /// The devices that exist.
        available: String,
    },

    /// The device lacks what the kernels need.
    #[error("the device cannot run this: {0}")]
    Unsupported(String),

    /// The device does not compute what the CPU twins do.
    #[error(
        "{device} computes wrong results ({what}): use another device or the CPU, and repeat the failure with {command}"
    )]
    WrongResults {
        /// The device's name.
        device: String,
        /// Which kernel, and in what it is wrong.
        what: String,
        /// What repeats it.
        command: String,
    },

    /// The device ran out of memory.
    #[error("the device ran out of memory for {0}: use a smaller picture or another device")]
    OutOfMemory(String),

    /// The device was lost; it has to be opened anew.
    #[error("the device was lost ({0}): open it again")]
    DeviceLost(String),

    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },

    /// A file's content is not what its format says.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and what would be right.
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
