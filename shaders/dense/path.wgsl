// One path of semi-global matching: the costs along all its lines.

#import line

struct Params {
    width: u32,
    // Of the band, and the row of the picture where it begins.
    rows: u32,
    first_row: u32,
    // Where the band begins in the volume of this path.
    path_start: u32,
    // Whether the row before the band's first one holds where the lines come from.
    goes_on: u32,
    // To the next pixel of a line, each -1, 0 or 1.
    dx: i32,
    dy: i32,
    // What follows is for the selection. Where the first path's volume begins, and how far it is to the next.
    volumes_start: u32,
    volume_words: u32,
    min_disparity: i32,
    disparities: u32,
    uniqueness: u32,
    // Where the confidences begin, four a word, and the winners' keys, a word a pixel.
    confidence_offset: u32,
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A word a pixel: the luma in the lowest byte.
@group(0) @binding(1) var<storage, read> reference: array<u32>;
// Four disparities a word, WORDS words a pixel, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<u32>;
@group(0) @binding(3) var<storage, read_write> paths: array<u32>;

@compute @workgroup_size(WORKGROUP, 1)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= line_count() {
        return;
    }
    var line = begin(id.x);
    for (var i = 0u; i < line_length(); i++) {
        let here = luma_at(line);
        let words = follow(line, here);
        let start = params.path_start + (u32(line.y) * params.width + u32(line.x)) * WORDS;
        for (var k = 0; k < WORDS; k++) { // unroll
            paths[start + k] = words[k];
        }
        line = next_of(line, words, here);
    }
}
