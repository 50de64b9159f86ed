//! What Mesa's RADV makes of kernels for an AMD chip that is not there.
//!
//! With `RADV_FORCE_FAMILY` the driver lists a device 'Null hardware', which executes nothing; but creating a compute pipeline runs
//! the whole compiler. The variable must be set when the driver is loaded, so that another process of the same program
//! compiles, and prints what the kernels need.

use std::{
    collections::BTreeMap,
    env,
    io::{self, Write},
    path::Path,
    process::{Command, Stdio},
};

use hsad::internals::Stage;

use crate::vulkan::Compiler;

/// Set in the process that compiles.
const CHIP: &str = "RADV_FORCE_FAMILY";

/// Why nothing is known where the driver is absent.
pub const NOT_INSTALLED: &str = "Mesa's RADV is not installed: there is no file radeon_icd.*.json";

/// Begins each line of a kernel's numbers.
const MARK: &str = "hsad-kernel";

/// What a kernel needs on a chip.
#[derive(Clone, Debug)]
pub struct Needs {
    /// The kernel's name.
    pub kernel: String,
    /// Vector registers per thread.
    pub registers: u64,
    /// Registers that did not fit and live in memory, vector and scalar.
    pub spilled: u64,
    /// Bytes of memory per wave in place of registers and indexed arrays.
    pub scratch: u64,
    /// Bytes of workgroup memory.
    pub shared: u64,
    /// Waves that a SIMD unit holds at once.
    pub waves: u64,
    /// Instructions of the program.
    pub instructions: u64,
    /// Time of the compilation, in seconds.
    pub seconds: f64,
}

impl Needs {
    /// Head of a table of kernels on `chip`, in Markdown.
    pub fn head(chip: &str) -> String {
        format!(
            "| {chip} | registers | spilled | scratch bytes per wave | workgroup bytes | waves per SIMD | instructions | \
             seconds |\n|---|---|---|---|---|---|---|---|"
        )
    }

    /// Row of the table.
    pub fn row(&self) -> String {
        let Self { kernel, registers, spilled, scratch, shared, waves, instructions, seconds } = self;
        format!(
            "| {kernel} | {registers} | {spilled} | {scratch} | {shared} | {waves} | {instructions} | {seconds:.2} |"
        )
    }
}

/// Compiles the kernels, prints what they need and returns `true`, if this is the process that compiles.
pub fn serve(kernels: &[(String, Stage)]) -> bool {
    if env::var_os(CHIP).is_none() {
        return false;
    }
    let compiler = Compiler::open().expect("the driver's null device");
    for (name, stage) in kernels {
        let (numbers, seconds) = compiler.compile(stage).unwrap_or_else(|error| panic!("{name}: {error}"));
        let numbers: String = numbers.iter().map(|(name, value)| format!("\t{name}={value}")).collect();
        writeln!(io::stdout(), "{MARK}\t{name}\t{seconds}{numbers}").expect("standard output");
    }
    true
}

/// What the kernels need on `chip`, such as `gfx1100`, or why that is not known. The same program, started with `arguments`,
/// [`serve`]s the kernels.
pub fn needs(chip: &str, arguments: &[&str]) -> Result<Vec<Needs>, String> {
    let driver = driver().ok_or(NOT_INSTALLED)?;
    let output = Command::new(env::current_exe().map_err(|error| error.to_string())?)
        .args(arguments)
        .env(CHIP, chip)
        .env("RADV_DEBUG", "nocache")
        .env("VK_DRIVER_FILES", &driver)
        .env("VK_ICD_FILENAMES", &driver)
        .stdin(Stdio::null())
        .output()
        .map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout);
    let kernels: Vec<_> = said.lines().filter_map(|line| line.split_once(MARK)).collect();
    if !output.status.success() || kernels.is_empty() {
        return Err(format!("{chip}: {said}{}", String::from_utf8_lossy(&output.stderr)));
    }
    kernels.iter().map(|(_, line)| parse(line).ok_or_else(|| format!("{chip}: unknown numbers in {line}"))).collect()
}

/// The file that tells Vulkan's loader about RADV.
fn driver() -> Option<String> {
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
    let files = folders.iter().flat_map(|folder| Path::new(folder).read_dir().into_iter().flatten().flatten());
    files.map(|file| file.path().to_string_lossy().into_owned()).find(|name| name.contains("radeon_icd"))
}

fn parse(line: &str) -> Option<Needs> {
    let mut parts = line.trim().split('\t');
    let (kernel, seconds) = (parts.next()?.to_owned(), parts.next()?.parse().ok()?);
    let numbers: BTreeMap<&str, u64> = parts
        .map(|part| part.split_once('=').and_then(|(name, value)| Some((name, value.parse().ok()?))))
        .collect::<Option<_>>()?;
    let number = |name: &str| numbers.get(name).copied();
    Some(Needs {
        kernel,
        registers: number("VGPRs")?,
        spilled: number("Spilled VGPRs")? + number("Spilled SGPRs")?,
        scratch: number("Scratch size")?,
        shared: number("LDS size")?,
        waves: number("Subgroups per SIMD")?,
        instructions: number("Instructions")?,
        seconds,
    })
}
