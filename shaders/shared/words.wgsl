// A word of a texture that holds them one after the other (src/gpu/words.rs).
fn word_of(words: texture_2d<u32>, index: u32) -> u32 {
    return textureLoad(words, vec2<u32>(index & ((1u << ROW_BITS) - 1u), index >> ROW_BITS), 0).x;
}
