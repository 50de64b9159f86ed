// A word of the texture `words` of the module around it, which holds them one after the other (src/gpu/words.rs). Not an
// argument, since Metal's language names how a texture is used in its type, and naga cannot for an argument.
fn word_at(index: u32) -> u32 {
    return textureLoad(words, vec2<u32>(index & ((1u << ROW_BITS) - 1u), index >> ROW_BITS)).x;
}
