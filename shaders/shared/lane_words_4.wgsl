// What a thread loads and stores of a volume at once: 4 words, the costs of 16 disparities.
//
// Constants:
//   LANE_WORDS   4

alias Words = vec4<u32>;

fn word(words: Words, t: i32) -> u32 {
    return words[t];
}

fn words_of(packed: array<u32, LANE_WORDS>) -> Words {
    return vec4<u32>(packed[0], packed[1], packed[2], packed[3]);
}
