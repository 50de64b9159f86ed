//! Every shader against its Rust side, without any GPU: parsed, validated, and its bindings compared.

use std::path::Path;

use hsad::{
    gpu::{Binding, Stage},
    wgpu::Limits,
};
use naga::{AddressSpace, StorageAccess};

/// What of `stage`'s shader is not as its Rust side says; empty where they agree.
fn disagreements(stage: &Stage) -> Vec<String> {
    let text = stage.wgsl();
    let module = match naga::front::wgsl::parse_str(&text) {
        Ok(module) => module,
        Err(error) => return vec![error.emit_to_string(&text)],
    };
    let mut found = Vec::new();
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    if let Err(error) = validator.validate(&module) {
        found.push(error.emit_to_string(&text));
    }
    let entries: Vec<_> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
    if entries != ["main"] {
        found.push(format!("entry points {entries:?}, not main alone"));
    }
    let mut bindings: Vec<_> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| {
            let at = variable.binding.as_ref()?;
            let size = module.types[variable.ty].inner.size(module.to_ctx());
            let binding = match variable.space {
                AddressSpace::Uniform => Ok(Binding::Uniform(size.into())),
                AddressSpace::Storage { access } if !access.contains(StorageAccess::STORE) => Ok(Binding::Read),
                AddressSpace::Storage { .. } => Ok(Binding::Write),
                other => Err(other),
            };
            Some(((at.group, at.binding), binding))
        })
        .collect();
    bindings.sort_by_key(|(at, _)| *at);
    let expected: Vec<_> = (0..).zip(stage.bindings).map(|(i, &binding)| ((0, i), Ok(binding))).collect();
    if bindings != expected {
        found.push(format!("the shader binds {bindings:?}, Rust {expected:?}"));
    }
    let storage = stage.bindings.iter().filter(|b| !matches!(b, Binding::Uniform(_))).count();
    if storage > 4 {
        found.push(format!("{storage} storage buffers, where a device need not offer more than 4"));
    }
    found
}

#[test]
fn every_shader_is_valid_and_binds_what_rust_binds() {
    let stages = hsad::stages();
    assert!(stages.len() >= 9);
    for stage in stages {
        let found = disagreements(&stage);
        assert!(found.is_empty(), "{}: {}", stage.name, found.join("\n"));
    }
}

/// A stage's name is that of its shader, its Rust file, its twin and its test.
#[test]
fn stages_are_named_the_same_everywhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_in = |folder: &str, name: &str| root.join(folder).join(name).with_extension("rs").is_file();
    for stage in hsad::stages() {
        let name = stage.name;
        assert!(is_in("src/reference", name), "{name} has no twin");
        assert!(is_in("tests/kernels", name), "{name} has no test");
        assert!(
            ["src", "src/features", "src/dense", "src/hybrid"].iter().any(|half| is_in(half, name)),
            "{name} has no Rust side"
        );
    }
    let mut shaders: Vec<_> = std::fs::read_dir(root.join("shaders"))
        .expect("the folder of the shaders")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file())
        .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
        .collect();
    let mut names: Vec<_> = hsad::stages().iter().map(|stage| stage.name.to_owned()).collect();
    shaders.sort();
    names.sort();
    names.dedup();
    assert_eq!(names, shaders);
}

#[test]
fn workgroups_fit_the_smallest_limits() {
    let limits = Limits::downlevel_defaults();
    for stage in hsad::stages() {
        let module = naga::front::wgsl::parse_str(&stage.wgsl()).expect("checked by another test");
        let [x, y, z] = module.entry_points[0].workgroup_size;
        assert!(x * y * z <= limits.max_compute_invocations_per_workgroup, "{}: {x}x{y}x{z}", stage.name);
        let memory: u32 = module
            .global_variables
            .iter()
            .filter(|(_, variable)| variable.space == AddressSpace::WorkGroup)
            .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()))
            .sum();
        assert!(memory < limits.max_compute_workgroup_storage_size, "{}: {memory} bytes", stage.name);
    }
}

/// The comparison itself must be able to fail.
#[test]
fn a_changed_copy_disagrees() {
    let good = hsad::luma::stage();
    let changed = |change: &dyn Fn(&mut Stage)| {
        let mut stage = good.clone();
        change(&mut stage);
        disagreements(&stage)
    };
    assert!(changed(&|_| ()).is_empty());
    let size_differs = changed(&|s| s.bindings = &[Binding::Uniform(12), Binding::Read, Binding::Write]);
    assert!(size_differs[0].contains("Uniform(12)"), "{size_differs:?}");
    assert_eq!(changed(&|s| s.bindings = &[Binding::Uniform(8), Binding::Write, Binding::Write]).len(), 1);
    assert_eq!(changed(&|s| s.bindings = &[Binding::Uniform(8), Binding::Read]).len(), 1);
    assert_eq!(changed(&|s| s.source = "fn other() {}").len(), 2);
    assert_eq!(changed(&|s| s.source = "not a shader").len(), 1);
    let five = &[Binding::Read, Binding::Read, Binding::Read, Binding::Read, Binding::Write];
    assert_eq!(changed(&|s| s.bindings = five).len(), 2);
}
