//! Pictures of more than 8 bits, of which few are in use.

use std::{fs, path::Path};

use hsad::{
    image::{Luma, Plane},
    io::{pfm, png},
};
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};

use crate::{pair::Pair, run::Run};

/// Share of wrong pixels of `planes` stored by `write`, and of the same in 8 bits.
fn wrong(file: &str, write: impl Fn(&Path, &Luma)) -> [f64; 2] {
    let (pair, folder) = (Pair::shipped("planes"), tempfile::tempdir().unwrap());
    let stored = |file: &str, write: &dyn Fn(&Path, &Luma)| {
        let paths = ["left", "right"].map(|view| folder.path().join(format!("{view}{file}")));
        write(&paths[0], &pair.left.luma());
        write(&paths[1], &pair.right.luma());
        Run::of(&paths[0], &paths[1], &[]).ends(0, &[]).holds(&pair.truth, 72).judges(&pair.truth).wrong(&pair.truth)
    };
    let shallow = |path: &Path, luma: &Luma| {
        let mut bytes = Vec::new();
        png::write_grey8(&mut bytes, luma).unwrap();
        fs::write(path, bytes).unwrap();
    };
    [stored(file, &write), stored("-8.png", &shallow)]
}

#[track_caller]
fn within_a_point([deep, shallow]: [f64; 2]) {
    assert!(deep < shallow + 0.01, "{deep} wrong, {shallow} in 8 bits");
}

/// A thermal camera's raw data: 16 bits, of which 500 values are in use, two of the upper 8 bits.
#[test]
fn a_few_hundred_of_16_bits_are_as_good_as_8() {
    within_a_point(wrong(".png", |path, luma| {
        let mut bytes = Vec::new();
        png::write_grey16(&mut bytes, &luma.map(|&grey| 29_400 + 2 * u16::from(grey))).unwrap();
        fs::write(path, bytes).unwrap();
    }));
}

fn floats(luma: &Luma) -> Plane<f32> {
    luma.map(|&grey| 0.001 * f32::from(grey) - 0.05)
}

#[test]
fn floats_are_as_good_as_8_bits() {
    within_a_point(wrong(".pfm", |path, luma| {
        let mut bytes = Vec::new();
        pfm::write(&mut bytes, &floats(luma)).unwrap();
        fs::write(path, bytes).unwrap();
    }));
    within_a_point(wrong(".tif", |path, luma| {
        let mut encoder = TiffEncoder::new(fs::File::create(path).unwrap()).unwrap();
        encoder.write_image::<Gray32Float>(luma.width(), luma.height(), floats(luma).data()).unwrap();
    }));
}
