//! From the costs of all paths to disparities.

use hsad::{
    dense::{DenseConfig, Direction, Interpolation, Penalties, Places, Select, Selection, VolumeBand, Wanted},
    disparity::{DisparityRange, SCALE},
    image::Plane,
    luma::pack,
    reference::{path, path_winners, select},
};

use crate::common::*;

const PENALTIES: Penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };
const BACK: Direction = Direction { dx: -1, dy: 0 };

/// The matches, confidences and keys when the last path is followed through `costs`, and the others are given.
fn on_device(reference: &Plane<u32>, costs: &[u8], stored: &[Vec<u8>], config: &DenseConfig) -> Vec<i32> {
    let device = &gpu().device;
    let (width, rows) = reference.size();
    let band = VolumeBand { width, first_row: 0, rows, range: config.range };
    let words = |bytes: &[u8]| bytemuck::pod_collect_to_vec::<u8, u32>(bytes);
    let all: Vec<u32> = stored.iter().flat_map(|path| words(path)).collect();
    let volume_words = band.row_words() * rows;
    let (volumes, costs, reference) = (upload(&all), upload(&words(costs)), upload(reference.data()));
    let confidence_offset = width * rows;
    let key_offset = confidence_offset + width.div_ceil(4) * rows;
    let matches = upload(&vec![0_u32; (key_offset + width * rows) as usize]);
    let selection = Selection {
        stored: stored.len() as u32,
        interpolation: config.interpolation,
        wanted: Wanted::Matches,
        keys: true,
        uniqueness: config.uniqueness,
    };
    let kernel = Select::new(device, &PENALTIES, band.words(), selection);
    let places = Places { start: 0, volume_words, confidence_offset, key_offset };
    let dispatch = kernel.prepare(device, &band, BACK, places, &reference, &costs, &volumes, &matches);
    run(|encoder| dispatch.record(encoder));
    download(&matches)
}

#[test]
fn the_twin_selects_the_same() {
    for (width, height) in SIZES {
        for (count, stored, uniqueness) in [(1, 3, 0), (2, 1, 0), (17, 3, 10), (40, 7, 1)] {
            for interpolation in [Interpolation::None, Interpolation::Parabola, Interpolation::Equiangular] {
                let range = DisparityRange::new(-3, count).unwrap();
                let config = DenseConfig { interpolation, uniqueness, ..DenseConfig::new(range) };
                let volume = |seed| picture(width * count.next_multiple_of(4), height, seed).data().to_vec();
                let mut volumes: Vec<_> = (0..stored).map(volume).collect();
                let reference = picture(width, height, 99).map(|&value| value.into());
                let costs: Vec<u8> = volume(55).iter().map(|&cost| cost / 2).collect();
                volumes.push(path(&reference, &costs, &PENALTIES, BACK));
                let expected = select(&volumes, (width, height), &config);
                let actual = on_device(&reference, &costs, &volumes[..stored as usize], &config);
                let pixels = (width * height) as usize;
                let (disparities, rest) = actual.split_at(pixels);
                let (confidences, keys) = rest.split_at(rest.len() - pixels);
                let winners = path_winners(&volumes, (width, height), &config);
                let key = |winner: &Option<(u32, i32)>| winner.map_or(-1, |(cost, d)| (cost << 16) as i32 | (d + 3));
                assert_same("keys", keys, winners.map(key).data());
                let what = format!("{width}x{height}, {count} disparities, {stored} paths and one, {interpolation:?}");
                assert_same(&what, disparities, expected.disparity.data());
                let expected: Vec<i32> = pack(&expected.confidence).into_iter().map(u32::cast_signed).collect();
                assert_same(&what, confidences, &expected);
            }
        }
    }
}

#[test]
fn by_hand() {
    // Sums 60 20 30 80: the second wins, its rival is the last. Left of it 40 more, right 10 more: the
    // parabola's vertex lies (40 - 10) / 2(40 + 10) = 0.3 px to the right.
    let range = DisparityRange::new(0, 4).unwrap();
    let config = DenseConfig { interpolation: Interpolation::Parabola, ..DenseConfig::new(range) };
    // In the first pixel of a line its costs are those of the path.
    let reference = Plane::filled(1, 1, 0);
    let matches = on_device(&reference, &[10, 5, 20, 40], &[vec![50, 15, 10, 40]], &config);
    assert_eq!(matches, [SCALE + 77, 1 + 254 * 60 / 80, 20 << 16 | 1]);
}
