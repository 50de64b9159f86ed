//! The hash of a twin's outputs.
//!
//! Only exact arrays are hashed. The floats of orientations and descriptors come from functions (`exp`, `atan2`,
//! `powf`) that differ in their last digits from platform to platform.

use super::array::{Array, Tolerance};
use crate::{fnv::fnv1a, image::Size};

/// The hashes of all cases, one line each.
pub(super) const STORED: &str = include_str!("goldens.txt");

/// The hash of the exact arrays among `arrays`: 64-bit FNV-1a over the name of each array, its number of values as
/// `u64` and its values, all little-endian. `None` if no array is exact.
pub fn hash(arrays: &[Array]) -> Option<u64> {
    let exact: Vec<&Array> = arrays.iter().filter(|array| array.tolerance == Tolerance::Exact).collect();
    let bytes = exact.iter().flat_map(|Array { name, values, .. }| {
        let length = (values.len() as u64).to_le_bytes();
        name.bytes().chain(length).chain(values.to_le_bytes())
    });
    (!exact.is_empty()).then(|| fnv1a(bytes))
}

/// The key of a case: its line in the file, without the hash.
pub(super) fn key(name: &str, Size { width, height }: Size, seed: u32) -> String {
    format!("{name} {width}x{height} {seed}")
}

/// The hash stored under `key`.
pub(super) fn stored(key: &str) -> Option<u64> {
    let hash = STORED.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(' '))?;
    u64::from_str_radix(hash, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_with_a_tolerance_are_not_hashed() {
        let exact = Array::exact("words", vec![1_u32, 2]);
        let tolerance = Tolerance::Within { difference: 0.1, angles: false, group: 1, length: None, outliers: None };
        let floats = Array { name: "floats", values: vec![1.5_f32].into(), tolerance };
        assert_eq!(hash(std::slice::from_ref(&floats)), None);
        assert_eq!(hash(&[exact.clone(), floats]), hash(std::slice::from_ref(&exact)));
        assert_ne!(hash(&[exact]), hash(&[Array::exact("words", vec![1_u32, 3])]));
    }
}
