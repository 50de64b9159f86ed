// What a thread loads and stores of a volume at once: 1 word, the costs of 4 disparities.
//
// Constants:
//   LANE_WORDS   1

alias Words = u32;

fn word(words: Words, t: i32) -> u32 {
    return words;
}

fn words_of(packed: array<u32, LANE_WORDS>) -> Words {
    return packed[0];
}
