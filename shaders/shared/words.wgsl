// Where a texture that holds words one after the other has one of them (src/gpu/words.rs).
fn place_of(index: u32) -> vec2<u32> {
    return vec2<u32>(index & ((1u << ROW_BITS) - 1u), index >> ROW_BITS);
}

// A word of the texture `words` of the module around it. Not an argument, since Metal's language names how a texture is
// used in its type, and naga cannot for an argument.
fn word_at(index: u32) -> u32 {
    return textureLoad(words, place_of(index)).x;
}
