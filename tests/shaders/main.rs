//! Every shader against its Rust side, without a GPU: parsed, validated, its bindings and structs compared, and
//! translated to the languages of drivers.

mod heads;
mod translations;

use std::{
    collections::BTreeSet,
    iter,
    num::NonZero,
    panic::resume_unwind,
    path::Path,
    sync::{Mutex, OnceLock},
    thread,
};

use hsad::{
    features::Keypoint,
    gpu::{Limit, REQUIRED_LIMITS},
    internals::{Binding, Member, ShaderType, Shape, Stage},
    wgpu::{Limits, TextureFormat},
};
use naga::{
    AddressSpace, Module, ScalarKind, StorageAccess, TypeInner,
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};

/// The module of a stage and the result of its validation, or the error.
type Validated = Result<(Module, ModuleInfo), String>;

fn valid(stage: &Stage) -> Validated {
    valid_text(&stage.wgsl())
}

fn valid_text(text: &str) -> Validated {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let capabilities = if has_subgroups(text) { Capabilities::SUBGROUP } else { Capabilities::empty() };
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| error.emit_to_string(text))?;
    Ok((module, info))
}

/// Whether a shader is for devices with subgroups alone.
fn has_subgroups(text: &str) -> bool {
    text.contains("@builtin(subgroup_")
}

/// All stages with their modules, shared by all tests, since large modules take seconds to parse.
fn modules() -> &'static [(Stage, Validated)] {
    static MODULES: OnceLock<Vec<(Stage, Validated)>> = OnceLock::new();
    MODULES.get_or_init(|| {
        let with_module = |stage: Stage| {
            let module = valid(&stage);
            (stage, module)
        };
        on_all_processors(hsad::internals::stages(), with_module)
    })
}

/// Runs `work` on each of `items`, on all processors and in any order; the results are in the order of `items`.
fn on_all_processors<I: Send, O: Send>(items: Vec<I>, work: impl Fn(I) -> O + Sync) -> Vec<O> {
    let left = Mutex::new(items.into_iter().enumerate());
    let next = || left.lock().expect("no panic while it is held").next();
    let mut done: Vec<(usize, O)> = thread::scope(|scope| {
        let count = thread::available_parallelism().map_or(1, NonZero::get);
        let one = || iter::from_fn(next).map(|(index, item)| (index, work(item))).collect::<Vec<_>>();
        let threads: Vec<_> = (0..count).map(|_| scope.spawn(one)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    });
    done.sort_by_key(|&(index, _)| index);
    done.into_iter().map(|(_, output)| output).collect()
}

/// The module of a stage that another test checks.
fn checked(module: &Validated) -> &(Module, ModuleInfo) {
    module.as_ref().expect("checked by another test")
}

/// The scalars of a WGSL type, each with its path of members, its offset in bytes and its type.
fn values_of(module: &Module, ty: naga::Handle<naga::Type>) -> Vec<(String, u64, String)> {
    let scalar = |scalar: naga::Scalar| match (scalar.kind, scalar.width) {
        (ScalarKind::Uint, 4) => "u32".into(),
        (ScalarKind::Sint, 4) => "i32".into(),
        (ScalarKind::Float, 4) => "f32".into(),
        _ => format!("{scalar:?}"),
    };
    match &module.types[ty].inner {
        TypeInner::Scalar(kind) => vec![(String::new(), 0, scalar(*kind))],
        TypeInner::Vector { size, scalar: kind } => {
            (0..*size as u64).map(|i| (format!("[{i}]"), i * u64::from(kind.width), scalar(*kind))).collect()
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(count), stride } => {
            let of_one = values_of(module, *base);
            (0..count.get().into())
                .flat_map(|i| of_one.iter().map(move |one| (i, one)))
                .map(|(i, (path, at, kind))| (format!("[{i}]{path}"), i * u64::from(*stride) + at, kind.clone()))
                .collect()
        }
        TypeInner::Struct { members, .. } => members
            .iter()
            .flat_map(|member| {
                let name = member.name.as_deref().unwrap_or("?");
                values_of(module, member.ty)
                    .into_iter()
                    .map(move |(path, at, kind)| (format!(".{name}{path}"), u64::from(member.offset) + at, kind))
            })
            .collect(),
        other => vec![(String::new(), 0, format!("{other:?}"))],
    }
}

/// The scalars of a Rust type, in the form of [`values_of`].
fn values_of_rust(shape: &Shape) -> Vec<(String, u64, String)> {
    match *shape {
        Shape::Scalar(name) => vec![(String::new(), 0, name.into())],
        Shape::Array(count, base) => {
            let of_one = values_of_rust(base);
            (0..count)
                .flat_map(|i| of_one.iter().map(move |one| (i, one)))
                .map(|(i, (path, at, kind))| (format!("[{i}]{path}"), i * size_of_rust(base) + at, kind.clone()))
                .collect()
        }
        Shape::Struct(_, members) => members
            .iter()
            .flat_map(|member| {
                let values = values_of_rust(&member.shape).into_iter();
                values.map(|(path, at, kind)| (format!(".{}{path}", member.name), member.offset + at, kind))
            })
            .collect(),
    }
}

fn size_of_rust(shape: &Shape) -> u64 {
    match *shape {
        Shape::Scalar(_) => 4,
        Shape::Array(count, base) => count * size_of_rust(base),
        Shape::Struct(size, _) => size,
    }
}

/// The difference between a WGSL type and a Rust type, if any.
fn difference(module: &Module, ty: naga::Handle<naga::Type>, shape: &Shape) -> Option<String> {
    let (wgsl, rust) = (values_of(module, ty), values_of_rust(shape));
    let size = u64::from(module.types[ty].inner.size(module.to_ctx()));
    if size != size_of_rust(shape) {
        return Some(format!("it has {size} bytes, Rust's {}", size_of_rust(shape)));
    }
    let first = (0..wgsl.len().max(rust.len())).find(|&i| wgsl.get(i) != rust.get(i))?;
    Some(format!("value {first} is {:?}, Rust's {:?}", wgsl.get(first), rust.get(first)))
}

/// Whether the type is a read-only storage texture of one `u32` per texel.
fn is_word_texture(module: &Module, ty: naga::Handle<naga::Type>) -> bool {
    let class = naga::ImageClass::Storage { format: naga::StorageFormat::R32Uint, access: StorageAccess::LOAD };
    module.types[ty].inner == TypeInner::Image { dim: naga::ImageDimension::D2, arrayed: false, class }
}

/// Whether the type is a texture of floats, as far as a module tells.
fn is_picture(module: &Module, ty: naga::Handle<naga::Type>) -> bool {
    let class = naga::ImageClass::Sampled { kind: ScalarKind::Float, multi: false };
    module.types[ty].inner == TypeInner::Image { dim: naga::ImageDimension::D2, arrayed: false, class }
}

/// Whether the type is a write-only storage texture of `format`.
fn is_map(module: &Module, ty: naga::Handle<naga::Type>, format: TextureFormat) -> bool {
    let format = match format {
        TextureFormat::R32Sint => naga::StorageFormat::R32Sint,
        TextureFormat::R32Float => naga::StorageFormat::R32Float,
        TextureFormat::R32Uint => naga::StorageFormat::R32Uint,
        _ => return false,
    };
    let class = naga::ImageClass::Storage { format, access: StorageAccess::STORE };
    module.types[ty].inner == TypeInner::Image { dim: naga::ImageDimension::D2, arrayed: false, class }
}

/// The disagreements of the shader of `stage`, with module `valid`, and its Rust side; empty if there are none.
fn disagreements(stage: &Stage, valid: &Validated) -> Vec<String> {
    let (module, _) = match valid {
        Ok(valid) => valid,
        Err(error) => return vec![error.clone()],
    };
    let mut found = Vec::new();
    let entries: Vec<_> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
    if entries != ["main"] {
        found.push(format!("entry points {entries:?}, not main alone"));
    }
    let storage = stage.bindings.iter().filter(|b| matches!(b, Binding::Read | Binding::Write)).count();
    if storage > 4 {
        found.push(format!("{storage} storage buffers, where a device need not offer more than 4"));
    }
    let mut bindings: Vec<_> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| Some((variable.binding.as_ref()?, variable)))
        .map(|(at, variable)| ((at.group, at.binding), variable))
        .collect();
    bindings.sort_by_key(|(at, _)| *at);
    let places: Vec<_> = bindings.iter().map(|(at, _)| *at).collect();
    let expected: Vec<_> = (0..stage.bindings.len() as u32).map(|i| (0, i)).collect();
    if places != expected {
        found.push(format!("the shader binds {places:?}, Rust {expected:?}"));
        return found;
    }
    for (((_, place), variable), binding) in bindings.into_iter().zip(stage.bindings) {
        let difference = match (variable.space, binding) {
            (AddressSpace::Uniform, Binding::Uniform(shape)) => difference(module, variable.ty, shape),
            (AddressSpace::Storage { access }, Binding::Read) if !access.contains(StorageAccess::STORE) => None,
            (AddressSpace::Storage { access }, Binding::Write) if access.contains(StorageAccess::STORE) => None,
            (AddressSpace::Handle, Binding::Words) if is_word_texture(module, variable.ty) => None,
            (AddressSpace::Handle, Binding::Picture) if is_picture(module, variable.ty) => None,
            (AddressSpace::Handle, Binding::Map(format)) if is_map(module, variable.ty, *format) => None,
            (space, binding) => Some(format!("it is in {space:?}, in Rust it is {binding:?}")),
        };
        found.extend(difference.map(|difference| format!("binding {place}: {difference}")));
    }
    // Structs of buffer elements: their WGSL name and their Rust shape.
    for (name, shape) in [("Keypoint", Keypoint::SHAPE)] {
        if let Some((ty, _)) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)) {
            found.extend(difference(module, ty, &shape).map(|difference| format!("{name}: {difference}")));
        }
    }
    found
}

#[test]
fn every_shader_is_valid_and_binds_what_rust_binds() {
    assert!(modules().len() >= 9);
    for (stage, module) in modules() {
        let found = disagreements(stage, module);
        assert!(found.is_empty(), "{}: {}", stage.name, found.join("\n"));
    }
}

/// The uniform buffers of a module that anything but a copy of the whole buffer reads.
fn inlinable(module: &Module) -> Vec<String> {
    let functions = module.entry_points.iter().map(|entry| &entry.function);
    let expressions = functions.chain(module.functions.iter().map(|(_, function)| function));
    let mut read = Vec::new();
    for arena in expressions.map(|function| &function.expressions) {
        for (_, expression) in arena.iter() {
            let (naga::Expression::Access { base, .. } | naga::Expression::AccessIndex { base, .. }) = expression
            else {
                continue;
            };
            if let naga::Expression::GlobalVariable(variable) = arena[*base]
                && module.global_variables[variable].space == AddressSpace::Uniform
            {
                read.extend(module.global_variables[variable].name.clone());
            }
        }
    }
    read
}

/// What lavapipe gets is valid, binds the same, and reads uniforms only to copy them: see `src/gpu/inlinable.rs`.
#[test]
fn no_uniform_is_inlinable_on_lavapipe() {
    let mut seen = BTreeSet::new();
    for (stage, plain) in modules().iter().filter(|(stage, _)| seen.insert(stage.name)) {
        let (module, _) = valid_text(&stage.wgsl_for_lavapipe()).expect("a valid module");
        let bound = module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some()).count();
        assert_eq!(bound, stage.bindings.len(), "{}", stage.name);
        let has_uniforms = stage.bindings.iter().any(|binding| matches!(binding, Binding::Uniform(_)));
        let is_seen = !inlinable(&checked(plain).0).is_empty();
        assert_eq!(is_seen, has_uniforms, "{}", stage.name);
        let left = inlinable(&module);
        assert!(left.is_empty(), "{}: {left:?}", stage.name);
    }
}

/// A stage has one name and one room in four places: its shader, its Rust side, its twin and its test. A second shader, for
/// GPUs, has `tile_` or `lane_` in front of the name.
#[test]
fn stages_are_named_the_same_everywhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut shaders = Vec::new();
    for room in ["luma", "rectify", "features", "dense", "kamencay"] {
        for entry in std::fs::read_dir(root.join("shaders").join(room)).expect("a room of shaders") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let stage = ["tile_", "lane_"].iter().find_map(|shape| name.strip_prefix(shape)).unwrap_or(&name);
            for place in [format!("src/{room}/kernels"), format!("src/cpu/{room}"), format!("tests/kernels/{room}")] {
                assert!(root.join(&place).join(stage).with_extension("rs").is_file(), "{place} has no {stage}.rs");
            }
            shaders.push(name);
        }
    }
    let mut names: Vec<_> = hsad::internals::stages().iter().map(|stage| stage.name.to_owned()).collect();
    shaders.sort();
    names.sort();
    names.dedup();
    assert_eq!(names, shaders);
}

#[test]
fn workgroups_fit_the_smallest_limits() {
    let limits = Limits::downlevel_defaults();
    for (stage, module) in modules() {
        let (module, _) = checked(module);
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

/// The required limits are those that the shaders need, no more and no less.
#[test]
fn required_limits_are_those_that_some_shader_needs() {
    let mut needed = std::collections::BTreeMap::new();
    let mut need = |name: &'static str, value: u64| {
        let most = needed.entry(name).or_insert(0);
        *most = value.max(*most);
    };
    // Limits that the host's code needs: one bind group, texture rows of words, and the largest number of workgroups.
    need("max_bind_groups", 1);
    need("max_texture_dimension_2d", 2048);
    need("max_compute_workgroups_per_dimension", 65_535);
    for (stage, module) in modules() {
        let (module, _) = checked(module);
        let [x, y, z] = module.entry_points[0].workgroup_size;
        need("max_compute_workgroup_size_x", x.into());
        need("max_compute_workgroup_size_y", y.into());
        need("max_compute_workgroup_size_z", z.into());
        need("max_compute_invocations_per_workgroup", (x * y * z).into());
        let shared = module.global_variables.iter().filter(|(_, variable)| variable.space == AddressSpace::WorkGroup);
        let shared = shared.map(|(_, variable)| u64::from(module.types[variable.ty].inner.size(module.to_ctx()))).sum();
        need("max_compute_workgroup_storage_size", shared);
        let count = |kind: fn(&Binding) -> bool| stage.bindings.iter().filter(|&binding| kind(binding)).count() as u64;
        need("max_bindings_per_bind_group", stage.bindings.len() as u64);
        need("max_uniform_buffers_per_shader_stage", count(|b| matches!(b, Binding::Uniform(_))));
        need("max_storage_buffers_per_shader_stage", count(|b| matches!(b, Binding::Read | Binding::Write)));
        need("max_sampled_textures_per_shader_stage", count(|b| matches!(b, Binding::Picture)));
        need("max_storage_textures_per_shader_stage", count(|b| matches!(b, Binding::Words | Binding::Map(_))));
        let uniforms = stage.bindings.iter().filter_map(|binding| match binding {
            Binding::Uniform(shape) => Some(size_of_rust(shape)),
            _ => None,
        });
        need("max_uniform_buffer_binding_size", uniforms.max().unwrap_or(0));
    }
    let required: std::collections::BTreeMap<_, _> =
        REQUIRED_LIMITS.iter().map(|&Limit { name, least, .. }| (name, least)).collect();
    assert_eq!(needed, required);
    let (defaults, least) = (Limits::downlevel_defaults(), |limit: &Limit| limit.least);
    assert!(REQUIRED_LIMITS.iter().all(|limit| (limit.of)(&defaults) >= least(limit)));
}

/// The comparison itself must be able to fail.
#[test]
fn a_changed_copy_disagrees() {
    let good = hsad::internals::luma::luma::stage();
    let changed = |change: &dyn Fn(&mut Stage)| {
        let mut stage = good.clone();
        change(&mut stage);
        disagreements(&stage, &valid(&stage))
    };
    assert!(changed(&|_| ()).is_empty());
    let uniforms = |members| [Binding::Uniform(Shape::Struct(8, members)), Binding::Read, Binding::Write];
    let member = |name, offset, ty| Member { name, offset, shape: Shape::Scalar(ty) };
    for (what, members) in [
        ("f32", [member("width", 0, "u32"), member("height", 4, "f32")]),
        ("depth", [member("width", 0, "u32"), member("depth", 4, "u32")]),
        (".height", [member("height", 0, "u32"), member("width", 4, "u32")]),
        ("8", [member("width", 0, "u32"), member("height", 8, "u32")]),
    ] {
        let bindings = uniforms(Vec::from(members).leak());
        let found = changed(&|s| s.bindings = Vec::from(bindings).leak());
        assert!(found.len() == 1 && found[0].contains(what), "{what}: {found:?}");
    }
    let larger = changed(&|s| s.bindings = &[Binding::Uniform(Shape::Struct(12, &[])), Binding::Read, Binding::Write]);
    assert!(larger[0].contains("it has 8 bytes, Rust's 12"), "{larger:?}");
    let [params, ..] = *good.bindings else { unreachable!("it has three") };
    let bound = |rest: &[Binding]| [&[params], rest].concat().leak();
    assert_eq!(changed(&|s| s.bindings = bound(&[Binding::Write, Binding::Write])).len(), 1);
    assert_eq!(changed(&|s| s.bindings = bound(&[Binding::Read])).len(), 1);
    assert_eq!(changed(&|s| s.source = "fn other() {}").len(), 2);
    assert_eq!(changed(&|s| s.source = "not a shader").len(), 1);
    let five = &[Binding::Read, Binding::Read, Binding::Read, Binding::Read, Binding::Write];
    assert_eq!(changed(&|s| s.bindings = five).len(), 2);
}
