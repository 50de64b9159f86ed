//! The kernels of the plan for GPUs fit the registers of real chips, by the compiler of Mesa's RADV, which needs no chip.

#[path = "../examples/registers/kernels.rs"]
mod kernels;
#[path = "../examples/registers/radv.rs"]
mod radv;
#[path = "../examples/registers/vulkan.rs"]
mod vulkan;

use std::io::{self, Write};

use radv::Needs;

/// Windows of block matching beside that of `fast`: the code of all is alike.
const WINDOWS: [u32; 2] = [3, 31];

/// Most instructions of a kernel: the compiler takes about 20 microseconds for each.
const MOST_INSTRUCTIONS: u64 = 6000;

/// Compiles the kernels, where the test below starts this program for a chip; else nothing.
#[test]
fn serves() {
    radv::serve(&kernels::kernels_of_gpus(&WINDOWS));
}

#[test]
fn no_kernel_of_a_gpu_spills_registers() {
    let names = kernels::kernels_of_gpus(&WINDOWS).len();
    for chip in ["gfx1100", "navi21", "vega10", "polaris10"] {
        let needs = match radv::needs(chip, &["serves", "--exact", "--nocapture"]) {
            Ok(needs) => needs,
            Err(reason) if reason == radv::NOT_INSTALLED => {
                // Past the capture of the test's output.
                writeln!(io::stderr(), "NOT RUN: the kernels on chips that are not there. {reason}")
                    .expect("standard error");
                return;
            }
            Err(reason) => panic!("{reason}"),
        };
        assert_eq!(needs.len(), names, "{chip}");
        let too_large: Vec<_> = needs
            .iter()
            .filter(|Needs { spilled, scratch, instructions, .. }| {
                spilled + scratch > 0 || *instructions > MOST_INSTRUCTIONS
            })
            .map(Needs::row)
            .collect();
        assert!(too_large.is_empty(), "{}\n{}", Needs::head(chip), too_large.join("\n"));
    }
}
