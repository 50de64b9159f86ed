// What the threads that share a line need of each other, through workgroup memory: one barrier per exchange, since two
// consecutive exchanges take one half of the memory each.
//
// The module has `params` with `elements`, the threads of a line that have disparities.
//
// Constants:
//   WORKGROUP   threads per workgroup

#import edges_of_costs

struct Builtins {
    @builtin(local_invocation_index) index: u32,
}

fn index_of(builtins: Builtins) -> u32 {
    return builtins.index;
}

var<workgroup> edges: array<Edges, 2 * WORKGROUP>;

// What `thread`, number `lane` of its line, needs of the others. `turn` is even and odd in turns.
fn exchanged_with(own: Edges, thread: u32, lane: u32, turn: u32) -> Neighbours {
    let half = (turn & 1u) * WORKGROUP;
    edges[half + thread] = own;
    workgroupBarrier();
    // Threads at the ends of a line read any neighbour.
    let before = edges[half + max(thread, 1u) - 1u].last;
    let after = edges[half + min(thread + 1u, WORKGROUP - 1u)].first;
    var least = edges[half + thread - lane].least;
    for (var k = 1u; k < params.elements; k++) {
        least = min(least, edges[half + thread - lane + k].least);
    }
    return Neighbours(before, after, least);
}
