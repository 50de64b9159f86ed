//! What every kernel of the plan for GPUs needs on AMD chips that are not there, by the compiler of Mesa's RADV:
//! `cargo run --example registers -- [CHIP...]`, with chips by RADV's names (gfx1100, navi21, vega10 and polaris10).
#![expect(clippy::print_stdout, reason = "a measurement prints")]

mod kernels;
mod radv;
mod vulkan;

const CHIPS: [&str; 4] = ["gfx1100", "navi21", "vega10", "polaris10"];

fn main() -> Result<(), String> {
    let windows: Vec<u32> = (3..=31).step_by(2).collect();
    if radv::serve(&kernels::kernels_of_gpus(&windows)) {
        return Ok(());
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let chips: Vec<&str> =
        if arguments.is_empty() { CHIPS.to_vec() } else { arguments.iter().map(String::as_str).collect() };
    for chip in chips {
        println!("{}", radv::Needs::head(chip));
        radv::needs(chip, &[])?.iter().for_each(|needs| println!("{}", needs.row()));
        println!();
    }
    Ok(())
}
