// What a thread loads and stores of a volume at once: 2 words, the costs of 8 disparities.
//
// Constants:
//   LANE_WORDS   2

alias Words = vec2<u32>;

fn word(words: Words, t: i32) -> u32 {
    return words[t];
}

fn words_of(packed: array<u32, LANE_WORDS>) -> Words {
    return vec2<u32>(packed[0], packed[1]);
}
