// What the threads that share a line tell each other of their path costs.

// Path costs of a thread's first and last disparity, and its least path cost.
struct Edges {
    first: u32,
    last: u32,
    least: u32,
}

// The last path cost of the thread before, the first one of the thread after, and the least one of the line.
struct Neighbours {
    before: u32,
    after: u32,
    least: u32,
}
