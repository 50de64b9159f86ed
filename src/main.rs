//! The command line of `hsad`.

fn main() {}
