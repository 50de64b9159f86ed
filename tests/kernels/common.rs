//! Helpers of all kernel tests: a device, pictures, comparisons.

use std::{path::Path, sync::OnceLock};

use hsad::{
    features::{FeatureConfig, Keypoint},
    gpu::{DeviceChoice, Gpu},
    image::Luma,
    io::Picture,
    verify::{Array, Bench, Comparison, Trial, Values, compare, trials::NonmaxTrial},
    wgpu,
};

pub use hsad::{
    gpu::block_on,
    verify::{SIZES, smooth_noise as picture},
};

/// The device of all tests.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open(&DeviceChoice::Best).expect("these tests need a device; lavapipe is one"))
}

/// The bench on that device.
pub fn bench() -> Bench<'static> {
    Bench::new(gpu())
}

/// Uploads `values` to a storage buffer.
pub fn upload<T: bytemuck::NoUninit>(values: &[T]) -> wgpu::Buffer {
    bench().upload(values).expect("a buffer that is not large")
}

/// Waits for the submitted work and downloads all of `buffer`.
pub fn download<T: bytemuck::Pod>(buffer: &wgpu::Buffer) -> Vec<T> {
    bench().download(buffer).expect("a device that works")
}

/// The outputs of the device, in the order of the trial's arrays.
#[track_caller]
pub fn leaves(trial: &dyn Trial) -> Vec<Values> {
    let arrays = bench().guarded("a test", || trial.on_device(&bench())).expect("a device that works");
    arrays.into_iter().map(|array| array.values).collect()
}

/// Asserts that device and twin have the same outputs, within the tolerances.
#[track_caller]
pub fn assert_twin(what: &str, trial: &dyn Trial) {
    for comparison in compare(trial, &bench()).expect("a device that works") {
        assert_eq!(comparison.fault, None, "{what}");
    }
}

/// Asserts equality element by element, and reports the first difference.
#[track_caller]
pub fn assert_same<T: Clone>(what: &str, actual: &[T], expected: &[T])
where
    Values: From<Vec<T>>,
{
    let array = |values: &[T]| Array::exact("elements", values.to_vec());
    assert_eq!(Comparison::new(&array(actual), &array(expected)).fault, None, "{what}");
}

/// A keypoint with nothing but a place.
pub fn keypoint(x: f32, y: f32, scale: f32) -> Keypoint {
    Keypoint { x, y, scale, orientation: 0.0, response: 0, octave: 0, index: 0 }
}

/// The keypoints that the twins find in a picture, in the order of the final list.
pub fn keypoints_of(picture: &Luma, threshold: f32) -> Vec<Keypoint> {
    let config = FeatureConfig { threshold, ..FeatureConfig::default() };
    NonmaxTrial::of_picture(picture, config).twins_keypoints()
}

/// Pictures of all [`SIZES`] and [`photographs`], each with a name.
pub fn pictures() -> Vec<(String, Luma)> {
    let noise = SIZES.map(|size| (size.to_string(), picture(size, 1)));
    let real = photographs().into_iter().map(|(name, picture)| (name, picture.luma()));
    noise.into_iter().chain(real).collect()
}

/// The left views of the rendered scenes, and of the real ones where they are present.
pub fn photographs() -> Vec<(String, Picture)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let real = root.join("../shared/data/stereo");
    let mut pictures = views_in(&root.join("data"));
    assert_eq!(pictures.len(), 3, "the scenes that come with the project");
    if real.is_dir() {
        pictures.extend(views_in(&real));
    } else {
        eprintln!("SKIPPED: real pictures, as {} is absent", real.display());
    }
    pictures
}

fn views_in(folder: &Path) -> Vec<(String, Picture)> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<_> =
        entries.map(|entry| entry.unwrap().path().join("left.png")).filter(|path| path.is_file()).collect();
    files.sort();
    files.into_iter().map(|path| (path.display().to_string(), hsad::io::load::load(&path).unwrap())).collect()
}

#[test]
#[should_panic(expected = "elements: value 2 is 4, not 3; 1 are off")]
fn a_changed_element_is_seen() {
    assert_same("copy", &[1, 2, 4], &[1, 2, 3]);
}

#[test]
#[should_panic(expected = "there are 2 elements i32, not 3 elements i32")]
fn a_missing_element_is_seen() {
    assert_same("copy", &[1, 2], &[1, 2, 3]);
}

#[test]
fn poison_reaches_every_word() {
    let buffer = upload(&[0_u32; 3]);
    bench().poison(&buffer);
    assert_eq!(download::<u32>(&buffer), [u32::MAX; 3]);
    assert_eq!(download::<u32>(&bench().output(2).unwrap()), [u32::MAX; 2]);
}
