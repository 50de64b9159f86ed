// One path of semi-global matching: the costs along all its lines.

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
