//! From the costs of all paths to disparities.

use hsad::{
    dense::{DenseConfig, Interpolation, Select, VolumeBand, Wanted},
    disparity::{DisparityRange, SCALE},
    luma::pack,
    reference::{path_winners, select},
};

use crate::common::*;

fn on_device(paths: &[Vec<u8>], size: (u32, u32), config: &DenseConfig) -> Vec<i32> {
    let device = &gpu().device;
    let (width, rows) = size;
    let band = VolumeBand { width, first_row: 0, rows, range: config.range };
    let volume_words = band.row_words() * rows;
    let all: Vec<u32> = paths.iter().flat_map(|path| bytemuck::pod_collect_to_vec::<u8, u32>(path)).collect();
    let volumes = upload(&all);
    let matches = upload(&vec![0_u32; (2 * width * rows + width.div_ceil(4) * rows) as usize]);
    let kernel =
        Select::new(device, paths.len() as u32, config.interpolation, Wanted::Matches, true, config.uniqueness);
    let dispatch = kernel.prepare(
        device,
        &band,
        &volumes,
        0,
        volume_words,
        &matches,
        [width * rows, width * rows + width.div_ceil(4) * rows],
    );
    poison(&matches);
    run(|encoder| dispatch.record(encoder));
    download(&matches)
}

#[test]
fn the_twin_selects_the_same() {
    for (width, height) in SIZES {
        for (count, paths, uniqueness) in [(1, 4, 0), (2, 1, 0), (17, 4, 10), (40, 8, 1)] {
            for interpolation in [Interpolation::None, Interpolation::Parabola, Interpolation::Equiangular] {
                let range = DisparityRange::new(-3, count).unwrap();
                let config = DenseConfig { interpolation, uniqueness, ..DenseConfig::new(range) };
                let volume = |seed| picture(width * count.next_multiple_of(4), height, seed).data().to_vec();
                let volumes: Vec<_> = (0..paths).map(volume).collect();
                let expected = select(&volumes, (width, height), &config);
                let actual = on_device(&volumes, (width, height), &config);
                let pixels = (width * height) as usize;
                let (disparities, rest) = actual.split_at(pixels);
                let (confidences, keys) = rest.split_at(rest.len() - pixels);
                let winners = path_winners(&volumes, (width, height), &config);
                let key = |winner: &Option<(u32, i32)>| winner.map_or(-1, |(cost, d)| (cost << 16) as i32 | (d + 3));
                assert_same("keys", keys, winners.map(key).data());
                let what = format!("{width}x{height}, {count} disparities, {paths} paths, {interpolation:?}");
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
    let matches = on_device(&[vec![50, 15, 10, 40], vec![10, 5, 20, 40]], (1, 1), &config);
    assert_eq!(matches, [SCALE + 77, 1 + 254 * 60 / 80, 20 << 16 | 1]);
}
