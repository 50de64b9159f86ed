//! Every shader, translated by naga to every language that a driver may get.
//!
//! `spirv-val` and `glslangValidator` check the translations if they are installed (Debian's packages spirv-tools and
//! glslang-tools). test.sh requires them, since the tests pass without them. MSL and HLSL have no checker here.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Stdio},
    sync::Mutex,
};

use hsad::internals::Stage;
use naga::{
    Module, ShaderStage,
    back::{glsl, hlsl, msl, spv},
    proc::BoundsCheckPolicies,
    valid::ModuleInfo,
};

use crate::{checked, has_subgroups, modules, on_all_processors, valid};

/// A target language, and the translation of a module to its text or binary.
struct Target {
    name: &'static str,
    translate: fn(&Module, &ModuleInfo) -> Result<Vec<u8>, String>,
    /// Checker of the translations, if installed: a program, its arguments, and a file extension.
    checker: Option<(&'static str, &'static [&'static str], &'static str)>,
}

const TARGETS: [Target; 5] = [
    Target {
        name: "SPIR-V 1.0, for Vulkan",
        translate: |module, info| spirv(module, info, (1, 0)),
        checker: Some(("spirv-val", &["--target-env", "vulkan1.1"], "spv")),
    },
    Target { name: "MSL 2.1, for Metal", translate: metal, checker: None },
    Target {
        name: "HLSL of shader model 5.1, for DirectX 12",
        translate: |module, info| directx(module, info, hlsl::ShaderModel::V5_1),
        checker: None,
    },
    Target {
        // With 4.30 naga selects between integers in a way that needs an extension.
        name: "GLSL 4.50, for OpenGL",
        translate: |module, info| opengl(module, info, glsl::Version::Desktop(450)),
        checker: Some(("glslangValidator", &["-S", "comp"], "comp")),
    },
    Target {
        name: "GLSL ES 3.10, for OpenGL ES",
        translate: |module, info| opengl(module, info, glsl::Version::new_gles(310)),
        checker: Some(("glslangValidator", &["-S", "comp"], "comp")),
    },
];

/// Where wgpu has subgroups.
const WITH_SUBGROUPS: [Target; 3] = [
    Target {
        name: "SPIR-V 1.3, for Vulkan",
        translate: |module, info| spirv(module, info, (1, 3)),
        checker: Some(("spirv-val", &["--target-env", "vulkan1.1"], "spv")),
    },
    Target { name: "MSL 2.1, for Metal", translate: metal, checker: None },
    Target {
        name: "HLSL of shader model 6.0, for DirectX 12",
        translate: |module, info| directx(module, info, hlsl::ShaderModel::V6_0),
        checker: None,
    },
];

fn spirv(module: &Module, info: &ModuleInfo, lang_version: (u8, u8)) -> Result<Vec<u8>, String> {
    let entry = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: "main".into() };
    let options = spv::Options { lang_version, ..Default::default() };
    let words = spv::write_vec(module, info, &options, Some(&entry)).map_err(|e| e.to_string())?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}

fn metal(module: &Module, info: &ModuleInfo) -> Result<Vec<u8>, String> {
    let options = msl::Options { lang_version: (2, 1), ..Default::default() };
    let (text, translated) =
        msl::write_string(module, info, &options, &msl::PipelineOptions::default()).map_err(|e| e.to_string())?;
    // Binding errors are reported per entry point.
    translated.entry_point_names.into_iter().try_for_each(|name| name.map(|_| ())).map_err(|e| e.to_string())?;
    Ok(text.into_bytes())
}

fn directx(module: &Module, info: &ModuleInfo, shader_model: hlsl::ShaderModel) -> Result<Vec<u8>, String> {
    let (options, entry) = (hlsl::Options { shader_model, ..Default::default() }, hlsl::PipelineOptions::default());
    let mut text = String::new();
    let written = hlsl::Writer::new(&mut text, &options, &entry).write(module, info, None);
    let written = written.map_err(|e| e.to_string())?;
    written.entry_point_names.into_iter().try_for_each(|name| name.map(|_| ())).map_err(|e| e.to_string())?;
    Ok(text.into_bytes())
}

fn opengl(module: &Module, info: &ModuleInfo, version: glsl::Version) -> Result<Vec<u8>, String> {
    let options = glsl::Options { version, ..Default::default() };
    let entry =
        glsl::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: "main".into(), multiview: None };
    let mut text = String::new();
    glsl::Writer::new(&mut text, module, info, &options, &entry, BoundsCheckPolicies::default())
        .and_then(|mut writer| writer.write())
        .map_err(|e| e.to_string())?;
    Ok(text.into_bytes())
}

/// The error of a module's translation or check; `None` if the target accepts it.
fn objection((module, info): &(Module, ModuleInfo), target: &Target, folder: &Path) -> Option<String> {
    let translated = match (target.translate)(module, info) {
        Err(error) => return Some(error),
        Ok(translated) if translated.is_empty() => return Some("nothing came out".into()),
        Ok(translated) => translated,
    };
    let (program, arguments, extension) = target.checker.filter(|(program, ..)| is_installed(program))?;
    let file = folder.join("module").with_extension(extension);
    fs::write(&file, translated).expect("a file in a temporary folder");
    let output = Command::new(program).args(arguments).arg(&file).output().expect("it is installed");
    (!output.status.success()).then(|| {
        let said = [output.stdout, output.stderr].concat();
        format!("{program}: {}", String::from_utf8_lossy(&said))
    })
}

/// Whether a program is installed; each program is tried once.
fn is_installed(program: &'static str) -> bool {
    static ASKED: Mutex<BTreeMap<&str, bool>> = Mutex::new(BTreeMap::new());
    let starts = || {
        let quiet = || Stdio::null();
        Command::new(program).arg("--version").stdout(quiet()).stderr(quiet()).status().is_ok()
    };
    *ASKED.lock().expect("no panic while it is held").entry(program).or_insert_with(starts)
}

#[test]
fn every_shader_can_be_told_in_every_language() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let check = |(index, (stage, module)): (usize, &(Stage, _))| {
        let folder = folder.path().join(index.to_string());
        fs::create_dir(&folder).expect("a folder in a temporary folder");
        let targets = if has_subgroups(&stage.wgsl()) { &WITH_SUBGROUPS[..] } else { &TARGETS };
        for target in targets {
            let objection = objection(checked(module), target, &folder);
            assert!(objection.is_none(), "{} in {}: {}", stage.name, target.name, objection.unwrap_or_default());
        }
    };
    on_all_processors(modules().iter().enumerate().collect(), check);
}

/// The check itself must be able to fail.
#[test]
fn what_a_language_lacks_is_seen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let module = valid(&hsad::internals::luma::luma::stage()).expect("checked by another test");
    let refuse = |target: &Target| Target { translate: |_, _| Err("no such thing".into()), ..*target };
    for target in &TARGETS {
        assert_eq!(objection(&module, target, folder.path()), None);
        assert_eq!(objection(&module, &refuse(target), folder.path()).as_deref(), Some("no such thing"));
        let nothing = Target { translate: |_, _| Ok(Vec::new()), ..*target };
        assert_eq!(objection(&module, &nothing, folder.path()).as_deref(), Some("nothing came out"));
        let garbage = Target { translate: |_, _| Ok(b"garbage".to_vec()), ..*target };
        let checked = target.checker.is_some_and(|(program, ..)| is_installed(program));
        assert_eq!(objection(&module, &garbage, folder.path()).is_some(), checked, "{}", target.name);
    }
}
