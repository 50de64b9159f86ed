// Reading u32 number `index` of a buffer that was copied to a texture, row by row (src/gpu/words.rs). Software drivers
// load from textures for all lanes at once.
//
// The module has the texture `words`.

// Constants:
//   ROW_BITS   log2 of the texels per row of the texture, one u32 per texel

fn texel_of(index: u32) -> vec2<u32> {
    return vec2<u32>(index & ((1u << ROW_BITS) - 1u), index >> ROW_BITS);
}

// Reads `words`, and has no parameter for the texture: in Metal's language the type of a texture says how the texture
// is accessed, and naga does not write that type for parameters.
fn word_at(index: u32) -> u32 {
    return textureLoad(words, texel_of(index)).x;
}
