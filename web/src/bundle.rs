//! Bundles the page in a folder that any web server can serve: the library in WebAssembly, the page's own files, and
//! the example pair.

use std::{
    env,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};
use wasm_bindgen_cli_support::Bindgen;

const TARGET: &str = "wasm32-unknown-unknown";
/// File name of the library in WebAssembly, from the name of its package.
const LIBRARY: &str = "hsad_web";
/// Files of the example pair and its camera.
const EXAMPLE: [&str; 3] = ["left.png", "right.png", "meta.json"];

/// Compiles the library for browsers and writes the bundle to `folder`, in place of an earlier one.
///
/// # Errors
/// If the target cannot be added, the compilation fails, or a file cannot be written.
pub fn bundle(folder: &Path) -> Result<()> {
    let web = Path::new(env!("CARGO_MANIFEST_DIR"));
    let wasm = compiled(web)?;
    // Files of an earlier bundle would be served, too.
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("clearing {}", folder.display()))?;
    }
    Bindgen::new()
        .input_path(&wasm)
        .web(true)
        .and_then(|bindgen| bindgen.omit_default_module_path(false).typescript(false).generate(folder))
        .with_context(|| format!("making bindings of {}", wasm.display()))?;
    let page = web.join("page");
    for entry in fs::read_dir(&page).with_context(|| format!("listing {}", page.display()))? {
        let path = entry?.path();
        copy(&path, &folder.join(path.file_name().unwrap_or_default()))?;
    }
    for name in EXAMPLE {
        copy(&web.join("../data/planes").join(name), &folder.join("example").join(name))?;
    }
    Ok(())
}

/// Cargo's target folder.
pub fn target_folder() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"), PathBuf::from)
}

/// Compiles the library for browsers and returns the path of the WebAssembly file.
fn compiled(web: &Path) -> Result<PathBuf> {
    if !has_target()? {
        run(Command::new("rustup").args(["target", "add", TARGET]))
            .with_context(|| format!("Rust's standard library for {TARGET} is missing and rustup cannot add it"))?;
    }
    let target = target_folder();
    let cargo = env::var_os("CARGO").unwrap_or("cargo".into());
    run(Command::new(cargo)
        .args(["build", "--lib", "--release", "--package", "hsad-web", "--target", TARGET, "--target-dir"])
        .arg(&target)
        .arg("--manifest-path")
        .arg(web.join("Cargo.toml")))?;
    Ok(target.join(TARGET).join("release").join(LIBRARY).with_extension("wasm"))
}

/// Whether the compiler that cargo calls has the standard library of the target.
fn has_target() -> Result<bool> {
    let rustc = env::var_os("RUSTC").unwrap_or("rustc".into());
    let output = Command::new(&rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
    let output = output.with_context(|| format!("running {}", rustc.display()))?;
    Ok(Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

fn run(command: &mut Command) -> Result<()> {
    let program = command.get_program().display().to_string();
    let status = command.status().with_context(|| format!("running {program}"))?;
    let arguments: Vec<_> = command.get_args().map(OsStr::to_string_lossy).collect();
    ensure!(status.success(), "{program} {} failed", arguments.join(" "));
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let name = || format!("copying {} to {}", from.display(), to.display());
    fs::create_dir_all(to.parent().unwrap_or(to)).and_then(|()| fs::copy(from, to)).with_context(name)?;
    Ok(())
}
