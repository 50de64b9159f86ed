// What the threads that share a line need of each other, by shuffles: no thread waits for another subgroup. A line lies within
// a subgroup.
//
// The module has `params` with `lanes`, the threads of a line, a power of two.

#import edges_of_costs

struct Builtins {
    @builtin(subgroup_id) subgroup: u32,
    @builtin(subgroup_size) size: u32,
    @builtin(subgroup_invocation_id) invocation: u32,
}

// Which threads form a subgroup is the device's choice: they are numbered by their subgroups.
fn index_of(builtins: Builtins) -> u32 {
    return builtins.subgroup * builtins.size + builtins.invocation;
}

// What a thread needs of the others of its line. At the ends of a line, of any neighbour.
fn exchanged_with(own: Edges, thread: u32, lane: u32, turn: u32) -> Neighbours {
    let before = subgroupShuffleUp(own.last, 1u);
    let after = subgroupShuffleDown(own.first, 1u);
    var least = own.least;
    for (var k = 1u; k < params.lanes; k <<= 1u) {
        least = min(least, subgroupShuffleXor(least, k));
    }
    return Neighbours(before, after, least);
}
