//! Levels of a pyramid: what the tests of their kernels share, and the pyramid as a whole.

use hsad::{
    Error,
    config::Preset,
    dense::{self, Aggregation, DenseConfig, Matcher, Pyramid, Search},
    disparity::{DisparityRange, NONE, SCALE},
    image::{Luma, Plane, Size},
    internals::{
        cpu::dense::CellVolume,
        dense::{CellRange, CellTable, Loss},
    },
    verify::trials::{DenseTrial, PyramidTrial},
};

use crate::common::*;

/// Sizes with several cells, the last ones cut off.
pub const LARGE: [Size; 2] = [Size::new(97, 70), Size::new(128, 33)];

/// A table with several ranges, of `count` disparities from -9.
pub fn table(size: Size, count: u32) -> CellTable {
    let range = DisparityRange::new(-9, count).unwrap();
    let whole = CellTable::whole(size, range);
    let all = CellRange::whole(count).words;
    let cells = Plane::from_fn(whole.cells.size(), |x, y| {
        let words = 4 * (1 + (x + y) % (all / 4));
        CellRange { first: (3 * x + 5 * y) % (all - words + 1), words }
    });
    CellTable { cells, ..whole }
}

/// Values from 0 to `most`.
pub fn volume(table: &CellTable, seed: u32, most: u8) -> CellVolume {
    let count = *CellVolume::starts(table).last().unwrap() as u32;
    let values = picture((count, 1), seed).into_data().into_iter().map(|value| value.min(most)).collect();
    CellVolume { table: table.clone(), values }
}

/// Texture with two steps of disparity, from 3 to 31 px.
fn trial(size: Size, preset: Preset, coarsest: u32, band_rows: u32) -> PyramidTrial {
    let right = picture(size, 1);
    let left = Luma::from_fn(size, |x, y| {
        let disparity = if (40..90).contains(&x) && y > 20 { 31 } else { 3 + y / 16 };
        right.get_clamped(i64::from(x) - i64::from(disparity), i64::from(y))
    });
    let config = preset.dense_config(DisparityRange::new(-4, 44).unwrap());
    let range = config.searched(size.width).unwrap();
    PyramidTrial {
        dense: DenseTrial { left, right, config, band_rows },
        pyramid: Pyramid::down_to(coarsest, size, range),
        hidden: None,
    }
}

/// Hides all but the middle of either view.
fn masked(trial: PyramidTrial, loss: Loss) -> PyramidTrial {
    let Size { width, height } = trial.dense.left.size();
    let middle = |edge: u32| {
        Luma::from_fn((width, height), |x, y| match (edge..width - edge).contains(&x) && y > height / 3 {
            true => 255,
            false => 0,
        })
    };
    PyramidTrial { hidden: Some(([middle(width / 8), middle(width / 4)], loss)), ..trial }
}

#[test]
fn the_twins_end_with_the_same_bytes() {
    for size in SIZES.into_iter().chain(LARGE).chain([Size::new(260, 131)]) {
        for (preset, coarsest) in [(Preset::Balanced, 40), (Preset::Quality, 70), (Preset::Balanced, 1)] {
            assert_twin(&format!("{size} {preset} down to {coarsest}"), &trial(size, preset, coarsest, u32::MAX));
        }
    }
}

#[test]
fn what_is_hidden_is_neither_searched_nor_shown() {
    let size = Size::new(260, 131);
    for loss in Loss::ALL {
        assert_twin(&format!("{loss:?} lost"), &masked(trial(size, Preset::Balanced, 70, u32::MAX), loss));
    }
}

#[test]
fn bands_leave_no_trace() {
    let size = Size::new(180, 131);
    for preset in [Preset::Balanced, Preset::Quality] {
        let whole = leaves(&trial(size, preset, 50, u32::MAX));
        for rows in [1, 7, 64] {
            assert_eq!(leaves(&trial(size, preset, 50, rows)), whole, "{preset} in bands of {rows}");
        }
    }
}

/// Wires `thick` px wide, 100 px before a texture at 10 px; the share of the wires' pixels with the right disparity.
fn wires_found(thick: u32, search: Search) -> f64 {
    let size = Size::new(1600, 200);
    let (texture, wire) = (picture(size, 5), picture(size, 6));
    let is_wire = |x: u32, y: u32| (x + y / 6) % 160 < thick;
    let left = Luma::from_fn(size, |x, y| if is_wire(x, y) { wire.get(x, y) / 4 } else { 64 + texture.get(x, y) / 2 });
    let right = Luma::from_fn(size, |x, y| match x + 110 {
        x if x < size.width && is_wire(x, y) => wire.get(x, y) / 4,
        _ => 64 + texture.get_clamped(i64::from(x) + 10, i64::from(y)) / 2,
    });
    let config = config(128, search);
    assert_eq!(Pyramid::of(&config, size).is_some(), search == Search::CoarseToFine);
    let map = block_on(dense::compute(gpu(), &left, &right, &config)).unwrap().disparity;
    let places = (0..200).flat_map(|y| (120..1600).map(move |x| (x, y))).filter(|&(x, y)| is_wire(x, y));
    let found: Vec<bool> =
        places.map(|(x, y)| map.get(x, y) != NONE && (map.get(x, y) - 110 * SCALE).abs() <= SCALE).collect();
    found.iter().filter(|&&right| right).count() as f64 / found.len() as f64
}

#[test]
fn thin_wires_survive_coarse_levels() {
    for thick in [2, 3, 4] {
        let [whole, pyramid] = [Search::Whole, Search::CoarseToFine].map(|search| wires_found(thick, search));
        assert!(
            whole > 0.8 && pyramid > whole - 0.1,
            "{thick} px: {pyramid} of the pixels, {whole} over the whole range"
        );
    }
}

fn config(count: u32, search: Search) -> DenseConfig {
    Preset::Balanced.dense_config(DisparityRange::new(0, count).unwrap()).with(|parameters| {
        let Aggregation::Costs(costs) = &mut parameters.aggregation else { panic!("costs") };
        costs.search = search;
    })
}

#[test]
fn a_matcher_records_whole_ranges_only() {
    let size = Size::new(1600, 16);
    let error = Matcher::new(gpu(), size, &config(128, Search::CoarseToFine)).unwrap_err();
    assert!(matches!(error, Error::Parameter { .. }), "{error}");
    assert!(error.to_string().contains("Search::Whole") && error.to_string().contains("dense::compute"), "{error}");
    let range = DisparityRange::new(0, 128).unwrap();
    assert_eq!(config(128, Search::Whole), Preset::Balanced.dense_config(range));
    assert_eq!(config(128, Search::CoarseToFine).parameters, Preset::Balanced.dense_parameters());
    Matcher::new(gpu(), size, &config(128, Search::Whole)).unwrap();
}
