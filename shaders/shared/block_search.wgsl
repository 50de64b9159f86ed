// The search of block matching: the keys of the disparities that four pixels have visited, and the check of a match by the
// other view's disparities.
//
// The module has `params` with `width`, `max_difference`, `others_first_row` and `others_width`, and the texture `others`:
// see block_match.wgsl.

#import selection
#import consistent
#import words

// Constants:
//   DIRECTION   partner column = column + DIRECTION * disparity: -1 if the reference is the left view, 1 if the right view
//   SHIFT       bits of a disparity's index in a key
//   FULL        1: disparities, checked and interpolated, and confidences; 0: the winners' whole disparities alone
//   HALVED      1: the other view's disparities are of a picture of half the size; 0: of the picture's size
//   NONE        sentinel: the pixel has no disparity

// Search state of four pixels: keys of the disparities visited so far, or NO_KEY. With FULL = 0 only
// `before` is used, for the best of all.
struct Search {
    // Key of the last disparity, and the best key of the disparities before the last.
    previous: vec4<u32>,
    before: vec4<u32>,
    // Best key of the disparities two or more away from the winner.
    rival: vec4<u32>,
    // Keys of the winner's two neighbours.
    below: vec4<u32>,
    above: vec4<u32>,
}

// Keys of the winners.
fn best_of(s: Search) -> vec4<u32> {
    return select(min(s.previous, s.before), s.before, FULL == 0);
}

// Visits the next disparity. `wins`: `key` is the best so far; `last_won`: the previous key was the best so far.
fn visit(s: Search, key: vec4<u32>, wins: vec4<bool>, last_won: vec4<bool>) -> Search {
    let no_key = vec4<u32>(NO_KEY);
    var next = s;
    if FULL == 0 {
        next.before = min(s.before, key);
        return next;
    }
    next.previous = key;
    next.before = best_of(s);
    // A key next to the winner is the winner's neighbour, later keys compete for the rival. The rival of a new winner
    // is the best key before the new winner's lower neighbour.
    next.rival = min(s.rival, select(select(key, no_key, last_won), s.before, wins));
    next.below = select(s.below, s.previous, wins);
    next.above = select(select(s.above, key, last_won), no_key, wins);
    return next;
}

// Shifts from the four bytes of a u32 to costs, which stand SHIFT bits up: one shift per byte, left or right.
const SHIFTS = vec4<i32>(SHIFT, SHIFT - 8, SHIFT - 16, SHIFT - 24);
const LEFT_SHIFTS = vec4<u32>(max(SHIFTS, vec4<i32>(0)));
const RIGHT_SHIFTS = vec4<u32>(max(-SHIFTS, vec4<i32>(0)));

fn unpack(word: u32) -> vec4<i32> {
    return vec4<i32>(((vec4<u32>(word) << LEFT_SHIFTS) >> RIGHT_SHIFTS) & vec4<u32>(255u << SHIFT));
}

// Whether the other view's disparity at the pixel's partner leads back; with HALVED at the partner or one of its two
// neighbours in the row, since at half the size a window extends twice as far across depth edges.
fn is_confirmed(x: u32, y: u32, disparity: i32) -> bool {
    let partner = partner_of(i32(x), disparity, DIRECTION);
    let row = (i32(y >> HALVED) + params.others_first_row) * i32(params.others_width);
    var holds = params.max_difference == 0xffffffffu;
    for (var i = 0; i < HALVED + HALVED + 1; i++) { // unroll
        let column = clamp((partner >> HALVED) + i - HALVED, 0, i32(params.others_width) - 1);
        let other = i32(textureLoad(others, texel_of(u32(row + column))).x);
        let scaled = select(NONE, other << HALVED, other != NONE);
        holds = holds || is_consistent(disparity, partner, params.width, scaled, params.max_difference);
    }
    return holds;
}
