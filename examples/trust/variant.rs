//! Variants of a scene: pairs made worse in ways that people meet, with their truth.

use hsad::{
    Config, Picture, Preset,
    eval::{
        conditions::{Changed, Condition, Kind},
        scene::Scene,
    },
    glam::{DAffine2, DVec2},
    image::{Plane, Size},
    internals::cpu::rectify::warp_colours,
    rectify::WarpMap,
};

use crate::{AnyError, scores};

/// Seeds of the noise in the left and in the right view.
const SEEDS: [u64; 2] = [1, 2];

/// What becomes of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variant {
    /// The scene as it is.
    AsIs,
    /// The right view lies lower, by this many pixels.
    Lower(f64),
    /// As [`Self::Lower`], matched without alignment.
    LowerNotAligned(f64),
    /// The right view is rotated about its centre, by this many degrees.
    Rotated(f64),
    /// The right view is enlarged about its centre by this factor.
    Enlarged(f64),
    /// Both views are blurred by a Gaussian of this standard deviation in pixels; then noise of 1 grey value is added.
    Blurred(f64),
    /// Both views are blurred over so many pixels along rows, as by a camera that moves; then noise of 1 grey value is added.
    Shaken(u32),
    /// Noise of this standard deviation in grey values is added to both views.
    Noisy(f64),
    /// The left view has 0.15 of its brightness, the right view 0.12.
    Dark,
    /// Both views are black outside the largest circle, as in pictures of a round lens.
    RoundMask,
    /// The range is told, and ends at the median of the truth.
    LowerHalf,
    /// The range is told, and begins at the median of the truth.
    UpperHalf,
    /// The right view is that of another scene, resized.
    OtherRight,
    /// The right view is turned by 180 degrees.
    UpsideDown,
}

impl Variant {
    /// Row differences, in pixels.
    pub const LOWER: [f64; 6] = [0.3, 0.7, 1.0, 1.4, 3.0, 10.0];

    /// The variants whose rows differ, the scene as it is first.
    pub fn of_rows() -> Vec<Self> {
        let lower = Self::LOWER.map(Self::Lower);
        [&[Self::AsIs][..], &lower, &[Self::Rotated(0.3), Self::Enlarged(1.01)]].concat()
    }

    /// The variants that are blurred.
    pub fn of_blur() -> Vec<Self> {
        [[1.5, 3.0].map(Self::Blurred), [9, 17].map(Self::Shaken)].concat()
    }

    /// All variants but those that are shaken; [`Self::OtherRight`] only if there is another scene.
    pub fn all(has_other: bool) -> Vec<Self> {
        let mut all = Self::of_rows();
        all.extend([1.0, 3.0].map(Self::LowerNotAligned));
        all.extend([1.5, 3.0, 5.0].map(Self::Blurred));
        all.extend([15.0, 35.0].map(Self::Noisy));
        all.extend([Self::Dark, Self::RoundMask, Self::LowerHalf, Self::UpperHalf, Self::UpsideDown]);
        all.extend(has_other.then_some(Self::OtherRight));
        all
    }

    /// The name in the tables.
    pub fn name(self) -> String {
        match self {
            Self::AsIs => "as given".into(),
            Self::Lower(rows) => format!("rows off by {rows} px"),
            Self::LowerNotAligned(rows) => format!("rows off by {rows} px, not aligned"),
            Self::Rotated(angle) => format!("rotated by {angle} degrees"),
            Self::Enlarged(scale) => format!("{:.0} % larger", 100.0 * (scale - 1.0)),
            Self::Blurred(sigma) => format!("blur {sigma} px"),
            Self::Shaken(length) => format!("blur along rows, {length} px"),
            Self::Noisy(deviation) => format!("noise {deviation}"),
            Self::Dark => "dark".into(),
            Self::RoundMask => "black outside a circle".into(),
            Self::LowerHalf => "range of the lower half".into(),
            Self::UpperHalf => "range of the upper half".into(),
            Self::OtherRight => "right view of another scene".into(),
            Self::UpsideDown => "right view upside down".into(),
        }
    }

    /// The variant of `scene` and how it is matched; `other` is the right view of another scene.
    pub fn of(self, scene: &Scene, other: &Picture) -> Result<(Scene, Config), AnyError> {
        let balanced = Preset::Balanced.config();
        let with_right = |right| Scene { right, ..scene.clone() };
        let of_known = |part: fn(&[f32]) -> &[f32]| -> Result<_, AnyError> {
            let range = Some(scores::range(part(&scores::known(scene)))?);
            Ok((scene.clone(), Config { range, ..balanced.clone() }))
        };
        let changed = match self {
            Self::AsIs => scene.clone(),
            Self::Lower(rows) => lower(scene, rows)?,
            Self::LowerNotAligned(rows) => return Ok((lower(scene, rows)?, Config { align: false, ..balanced })),
            Self::Rotated(angle) => moved(scene, Condition::new(Kind::Rotation, angle)?.apply(&scene.right, 0)),
            Self::Enlarged(scale) => moved(scene, Condition::new(Kind::Scale, scale)?.apply(&scene.right, 0)),
            Self::Blurred(sigma) => by(scene, [[(Kind::Blur, sigma), (Kind::Noise, 1.0)]; 2])?,
            Self::Shaken(length) => {
                let [left, right] = [&scene.left, &scene.right].map(|view| along_rows(view, length));
                by(&Scene { left, right, ..scene.clone() }, [[(Kind::Noise, 1.0)]; 2])?
            }
            Self::Noisy(deviation) => by(scene, [[(Kind::Noise, deviation)]; 2])?,
            Self::Dark => by(scene, [[(Kind::Gain, 0.15)], [(Kind::Gain, 0.12)]])?,
            Self::RoundMask => Scene { left: in_circle(&scene.left), right: in_circle(&scene.right), ..scene.clone() },
            Self::LowerHalf => return of_known(|known| &known[..known.len().div_ceil(2)]),
            Self::UpperHalf => return of_known(|known| &known[known.len() / 2..]),
            Self::OtherRight => with_right(resized(other, scene.right.size())?),
            Self::UpsideDown => with_right(Condition::new(Kind::Rotation, 180.0)?.apply(&scene.right, 0).picture),
        };
        Ok((changed, balanced))
    }
}

/// Changes that move nothing, those of the left and those of the right view.
fn by<const N: usize>(scene: &Scene, changes: [[(Kind, f64); N]; 2]) -> Result<Scene, AnyError> {
    let [left, right] = changes.map(|view| view.map(|(kind, strength)| Condition::new(kind, strength)));
    let changed = |view: [hsad::Result<Condition>; N], picture: &Picture, seed| {
        let conditions = view.into_iter().collect::<hsad::Result<Vec<_>>>()?;
        Ok::<_, AnyError>(Changed::by(&conditions, picture, seed).picture)
    };
    Ok(Scene {
        left: changed(left, &scene.left, SEEDS[0])?,
        right: changed(right, &scene.right, SEEDS[1])?,
        ..scene.clone()
    })
}

/// The right view lowered by `rows` pixels; rows that come from beyond its edge are unseen, with an alpha of 0.
fn lower(scene: &Scene, rows: f64) -> Result<Scene, AnyError> {
    let size = scene.right.size();
    let map = WarpMap::new(size, size, |place| place - DVec2::new(0.0, rows))?;
    let (picture, visible) = (warp_colours(&scene.right, &map), map.visible());
    Ok(moved(scene, Changed { picture, map: DAffine2::from_translation(DVec2::new(0.0, rows)), visible }))
}

/// A scene whose right view was moved: disparities of the truth follow its columns, and pixels whose partner left the picture
/// through the top or the bottom have no truth.
fn moved(scene: &Scene, Changed { picture, map, .. }: Changed) -> Scene {
    let Size { width, height } = scene.truth.size();
    let truth = Plane::from_fn((width, height), |x, y| {
        let disparity = f64::from(scene.truth.get(x, y));
        let partner = map.transform_point2(DVec2::new(f64::from(x) - disparity, y.into()));
        let is_seen = (-0.5..f64::from(height) - 0.5).contains(&partner.y);
        if disparity.is_finite() && is_seen { (f64::from(x) - partner.x) as f32 } else { f32::INFINITY }
    });
    Scene { right: picture, truth, ..scene.clone() }
}

/// The picture, each pixel the mean of `length` pixels of its row, an odd number.
fn along_rows(picture: &Picture, length: u32) -> Picture {
    let reach = i64::from(length / 2);
    Picture::from_fn(picture.size(), |x, y| {
        let around = (-reach..=reach).map(|i| picture.get_clamped(i64::from(x) + i, y.into()));
        let sums = around.fold([0; 4], |sums: [u32; 4], pixel| [0, 1, 2, 3].map(|c| sums[c] + u32::from(pixel[c])));
        sums.map(|sum| ((2 * sum + length) / (2 * length)) as u8)
    })
}

/// The picture, black outside the largest circle about its centre.
fn in_circle(picture: &Picture) -> Picture {
    let Size { width, height } = picture.size();
    let (across, down) = (i64::from(width) - 1, i64::from(height) - 1);
    let diameter = i64::from(width.min(height));
    Picture::from_fn((width, height), |x, y| {
        let [dx, dy] = [2 * i64::from(x) - across, 2 * i64::from(y) - down];
        if dx * dx + dy * dy < diameter * diameter { picture.get(x, y) } else { [0, 0, 0, 255] }
    })
}

/// The picture, stretched to `size`.
fn resized(picture: &Picture, size: Size) -> Result<Picture, AnyError> {
    let source = picture.size();
    let side = |size: Size| DVec2::new(size.width.into(), size.height.into());
    let factor = side(source) / side(size);
    Ok(warp_colours(picture, &WarpMap::new(size, source, |place| (place + 0.5) * factor - 0.5)?))
}

#[cfg(test)]
mod tests {
    use hsad::dense::View;

    use super::*;

    /// A ramp down the rows, of 4 grey values per row, and a truth of 1 to 40 px.
    fn scene() -> Scene {
        let ramp = Picture::from_fn((40, 30), |_, y| [4 * y as u8 + 100, 50, 60, 255]);
        let truth = Plane::from_fn((40, 30), |x, _| x as f32 + 1.0);
        Scene { left: ramp.clone(), right: ramp, reference: View::Left, truth, non_occluded: None }
    }

    fn variant(variant: Variant) -> (Scene, Config) {
        let other = Picture::from_fn((80, 60), |x, _| [x as u8, 0, 0, 255]);
        variant.of(&scene(), &other).unwrap()
    }

    #[test]
    fn a_lower_view_shows_the_rows_above() {
        let (changed, config) = variant(Variant::Lower(1.25));
        // 5 grey values less; the first row is unseen.
        assert_eq!((changed.right.get(7, 10), changed.right.get(7, 0)[3]), ([135, 50, 60, 255], 0));
        assert_eq!((changed.truth.get(7, 10), changed.truth.get(7, 29)), (8.0, f32::INFINITY));
        assert!(config.align && !variant(Variant::LowerNotAligned(1.0)).1.align);
        assert_eq!(changed.left, scene().left);
    }

    #[test]
    fn the_truth_follows_a_moved_view() {
        // Column 7 - 8 = -1 lies 20.5 px left of the centre: 1 % of that is 0.205 px.
        let (changed, _) = variant(Variant::Enlarged(1.01));
        assert!((changed.truth.get(7, 10) - 8.205).abs() < 1e-4);
        // A quarter turn about (19.5, 14.5): the partner (-1, 10) goes to (24, -6), above the picture.
        let (changed, _) = variant(Variant::Rotated(90.0));
        assert_eq!(changed.truth.get(7, 10), f32::INFINITY);
    }

    #[test]
    fn told_ranges_hold_half_of_the_truth() {
        let range = |half| variant(half).1.range.map(|range| (range.min, range.last()));
        assert_eq!([range(Variant::LowerHalf), range(Variant::UpperHalf)], [Some((1, 20)), Some((21, 40))]);
    }

    #[test]
    fn both_views_change_each_in_its_way() {
        let (noisy, _) = variant(Variant::Noisy(15.0));
        assert!(
            noisy.left != noisy.right
                && noisy.left != scene().left
                && noisy.left == variant(Variant::Noisy(15.0)).0.left
        );
        let (dark, _) = variant(Variant::Dark);
        // 0.15 * 140 and 0.12 * 140.
        assert_eq!((dark.left.get(0, 10)[0], dark.right.get(0, 10)[0]), (21, 17));
        assert_eq!(
            along_rows(&Picture::from_fn((5, 1), |x, _| [u8::from(x == 4) * 90, 0, 0, 255]), 3).get(4, 0)[0],
            60
        );
        let (masked, _) = variant(Variant::RoundMask);
        // The circle of 30 px reaches from column 5 to column 34.
        let row = [4, 5, 34, 35].map(|x| masked.right.get(x, 14)[1]);
        assert_eq!((row, masked.left == masked.right), ([0, 50, 50, 0], true));
    }

    #[test]
    fn other_right_views_have_the_size_of_the_scene() {
        // Pixel 10 of half the size lies at 20.5 of the source.
        let (other, _) = variant(Variant::OtherRight);
        assert_eq!((other.right.size(), other.right.get(10, 3)[0]), (scene().right.size(), 21));
        let (turned, _) = variant(Variant::UpsideDown);
        assert_eq!(turned.right.get(3, 0), scene().right.get(36, 29));
    }

    #[test]
    fn each_variant_has_its_own_name() {
        let mut names: Vec<String> = Variant::all(true).into_iter().map(Variant::name).collect();
        names.sort();
        names.dedup();
        assert_eq!((names.len(), Variant::all(false).len()), (22, 21));
    }
}
