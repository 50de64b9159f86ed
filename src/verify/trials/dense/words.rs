//! Costs of 8 bits, packed as volumes hold them.

/// Packs four 8-bit costs per `u32`.
pub(super) fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|&four| u32::from_le_bytes(four)).collect()
}

/// Unpacks four 8-bit costs per `u32`.
pub(super) fn bytes(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}
