//! What follows on the matching of a map, in windows of rows.

use std::ops::Range;

use super::{Surroundings, agreement, fill, residual, support, weighted_median};
use crate::{
    cpu::luma::rgba,
    dense::{After, Dense, DenseConfig, Filters, View},
    image::{Luma, Plane, Size},
};

/// Pixels of a window without its halo.
const WINDOW: u32 = 1 << 21;
/// Bytes per pixel of a window: views, residuals, and the maps before, between and after the filters; and those of what the
/// filling of holes reads.
const BYTES: u64 = 48;
const SURROUNDINGS: u64 = 48;

/// The map of the pair `views`, before the change of brightness, after its checks and filters. Holes are filled by the colours
/// of `picture`, the reference view, or by its luma, but for those that `own`, the mask of the reference view, hides.
///
/// A large map is worked on in windows of rows with a halo of as many rows as checks and filters reach; the result does not
/// depend on where windows are cut.
pub(super) fn checked_and_refined(
    views: [&Luma; 2],
    picture: Option<&Plane<[u8; 4]>>,
    own: Option<&Luma>,
    dense: Dense,
    after: &After,
    config: &DenseConfig,
) -> Dense {
    let rows = (WINDOW / dense.disparity.width()).max(1);
    in_windows(views, (picture, own), dense, after, config, rows)
}

/// Memory of the windows of a map of `size`, in bytes.
pub(super) fn bytes(size: Size, after: &After) -> u64 {
    let surroundings = if after.fills() { SURROUNDINGS } else { 0 };
    (BYTES + surroundings)
        * size.pixels().min(u64::from(WINDOW) + u64::from(size.width) * u64::from(2 * after.halo() + 1))
}

/// [`checked_and_refined`] in windows of `rows` rows without their halo.
pub(super) fn in_windows(
    views: [&Luma; 2],
    (picture, own): (Option<&Plane<[u8; 4]>>, Option<&Luma>),
    mut dense: Dense,
    after: &After,
    config: &DenseConfig,
    rows: u32,
) -> Dense {
    let Size { width, height } = dense.disparity.size();
    let halo = after.halo();
    // The halo above a window, as it was before.
    let mut above: Option<Dense> = None;
    for first in (0..height).step_by(rows as usize) {
        let (top, end) = (first.saturating_sub(halo), height.min(first.saturating_add(rows)));
        let bottom = height.min(end + halo);
        let mut window = joined(above, cut(&dense, first..bottom));
        above = (end < height).then(|| cut(&window, end.saturating_sub(halo) - top..end - top));
        if let Some(least) = after.agreement {
            agreement(&mut window, least);
        }
        if let Some(filters) = &after.filters {
            let picture = picture.map(|picture| picture.cut(top..bottom));
            let own = own.map(|mask| mask.cut(top..bottom));
            window = filtered(views.map(|view| view.cut(top..bottom)), (picture, own), &window, filters, config);
        }
        let place = (first * width) as usize..(end * width) as usize;
        let Dense { disparity, confidence } = cut(&window, first - top..end - top);
        dense.disparity.data_mut()[place.clone()].copy_from_slice(disparity.data());
        dense.confidence.data_mut()[place].copy_from_slice(confidence.data());
    }
    dense
}

fn filtered(
    [left, right]: [Luma; 2],
    (picture, own): (Option<Plane<[u8; 4]>>, Option<Luma>),
    dense: &Dense,
    filters: &Filters,
    config: &DenseConfig,
) -> Dense {
    let equalised = right.map(|&luma| config.brightness.apply(luma));
    let residuals = residual([&left, &equalised], config.reference, &dense.disparity);
    let luma = if config.reference == View::Left { left } else { right };
    let mut refined = support(dense, &residuals, filters.support, filters.majority);
    for &median in &filters.before {
        refined.disparity = weighted_median(&luma, &refined.disparity, median);
    }
    if filters.fill {
        let picture = picture.unwrap_or_else(|| rgba(&luma));
        let surroundings = Surroundings::new(&refined.disparity, config.reference, config.range, &picture);
        refined = fill(&refined, &surroundings, own.as_ref(), config.reference, config.range);
    }
    for &median in &filters.after {
        refined.disparity = weighted_median(&luma, &refined.disparity, median);
    }
    refined
}

/// The given rows of a map.
fn cut(dense: &Dense, rows: Range<u32>) -> Dense {
    Dense { disparity: dense.disparity.cut(rows.clone()), confidence: dense.confidence.cut(rows) }
}

/// One map of the rows of two.
fn joined(above: Option<Dense>, below: Dense) -> Dense {
    fn planes<T: Copy>(above: Plane<T>, below: &Plane<T>) -> Plane<T> {
        let size = Size::new(above.width(), above.height() + below.height());
        let mut data = above.into_data();
        data.extend_from_slice(below.data());
        Plane::new(size, data).expect("rows of one width")
    }
    match above {
        None => below,
        Some(above) => Dense {
            disparity: planes(above.disparity, &below.disparity),
            confidence: planes(above.confidence, &below.confidence),
        },
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::{config::Preset, cpu::dense::compute, disparity::DisparityRange};

    /// A pair with a step and a slope of disparities, and grain.
    pub(in crate::cpu::dense) fn pair(size: Size) -> [Luma; 2] {
        let grain =
            |x: i64, y: i64| (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).rotate_left(9) >> 5 & 255;
        let scene = |x: i64, y: i64| (grain(x / 3, y / 2) * 3 + grain(x, y)) / 4;
        let right = Luma::from_fn(size, |x, y| scene(x.into(), y.into()) as u8);
        let left = Luma::from_fn(size, |x, y| {
            let disparity = i64::from(x + y) / 9 + if x > size.width / 2 { 5 } else { 0 };
            (scene(i64::from(x) - disparity, y.into()) + grain(y.into(), x.into()) / 16).min(255) as u8
        });
        [left, right]
    }

    #[test]
    fn windows_do_not_change_the_result() {
        // Higher than checks and filters reach.
        let [left, right] = pair(Size::new(41, 300));
        for preset in [Preset::Fast, Preset::Balanced, Preset::Quality] {
            let config = preset.dense_config(DisparityRange::new(0, 16).unwrap());
            let matched = config.clone().with(|parameters| {
                parameters.agreement = 0;
                parameters.refinement = None;
            });
            let dense = compute(&left, &right, &matched).unwrap();
            let after = After::of(&config.parameters);
            for own in [None, Some(&Luma::from_fn(left.size(), |x, y| if (x + y) % 50 < 20 { 0 } else { 255 }))] {
                let windows = |rows| in_windows([&left, &right], (None, own), dense.clone(), &after, &config, rows);
                let expected = windows(300);
                assert_ne!(expected, dense, "{preset}");
                for rows in [7, 100, 299] {
                    assert_eq!(windows(rows), expected, "{preset}, {rows}");
                }
            }
        }
    }
}
