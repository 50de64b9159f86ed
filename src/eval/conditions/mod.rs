//! Conditions: synthetic changes of the second view, each with a strength and exact ground truth for the positions.
//!
//! A changed picture is the same bytes for the same seed on every machine: only integers, `f64` arithmetic and
//! functions of `libm` are used, which are arithmetic themselves.

mod brightness;
mod cover;
mod random;

use std::{fmt, str::FromStr};

use glam::{DAffine2, DVec2};

use crate::{
    error::{Error, Result},
    filter,
    image::{Plane, Size},
    io::Picture,
};
use random::Random;

/// Kind of change. Each has a strength; at its neutral strength nothing changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Colour values are multiplied by the strength.
    Gain,
    /// Colour values, scaled to 0 to 1, are raised to the power of the strength.
    Gamma,
    /// Colour values are multiplied by a factor that grows linearly from `1 - strength` in the first column to
    /// `1 + strength` in the last one.
    Ramp,
    /// Normal noise is added, independent in each colour of each pixel; the strength is its standard deviation in grey
    /// levels.
    Noise,
    /// Gaussian blur; the strength is its standard deviation in pixels.
    Blur,
    /// Rotation about the centre; the strength is the angle in degrees, clockwise on the screen. The picture keeps its
    /// size: corners are cut off.
    Rotation,
    /// Enlargement about the centre by the strength. The picture keeps its size: the border is cut off, or filled.
    Scale,
    /// Patches of random colours occlude the picture; the strength is the hidden share, 0 to 1.
    Clutter,
    /// A frame of one colour occludes the picture; on each side it hides half the strength as a share of width or
    /// height.
    Occlusion,
}

/// Name and strengths of a kind.
struct Facts {
    name: &'static str,
    neutral: f64,
    range: [f64; 2],
    usual: f64,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 9] = [
        Self::Gain,
        Self::Gamma,
        Self::Ramp,
        Self::Noise,
        Self::Blur,
        Self::Rotation,
        Self::Scale,
        Self::Clutter,
        Self::Occlusion,
    ];

    fn facts(self) -> Facts {
        let facts = |name, neutral, range, usual| Facts { name, neutral, range, usual };
        match self {
            Self::Gain => facts("gain", 1.0, [0.1, 4.0], 0.6),
            Self::Gamma => facts("gamma", 1.0, [0.2, 5.0], 2.0),
            Self::Ramp => facts("ramp", 0.0, [-1.0, 1.0], 0.5),
            Self::Noise => facts("noise", 0.0, [0.0, 100.0], 10.0),
            Self::Blur => facts("blur", 0.0, [0.0, 20.0], 1.5),
            Self::Rotation => facts("rotation", 0.0, [-180.0, 180.0], 30.0),
            Self::Scale => facts("scale", 1.0, [0.5, 2.0], 1.5),
            Self::Clutter => facts("clutter", 0.0, [0.0, 0.9], 0.2),
            Self::Occlusion => facts("occlusion", 0.0, [0.0, 0.9], 0.3),
        }
    }

    /// Name of the kind in one word.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// The strength at which nothing changes.
    pub fn neutral(self) -> f64 {
        self.facts().neutral
    }

    /// Smallest and largest strength.
    pub fn range(self) -> [f64; 2] {
        self.facts().range
    }

    /// Default strength.
    pub fn usual(self) -> f64 {
        self.facts().usual
    }
}

/// A kind of change at a strength within its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    kind: Kind,
    strength: f64,
}

impl Condition {
    /// A condition of `kind` at `strength`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the strength lies outside the kind's range.
    pub fn new(kind: Kind, strength: f64) -> Result<Self> {
        let [least, greatest] = kind.range();
        if !(least..=greatest).contains(&strength) {
            return Err(Error::Parameter {
                name: kind.name(),
                value: strength.to_string(),
                expected: format!(
                    "its strength must be {least} to {greatest}, and changes nothing at {}",
                    kind.neutral()
                ),
            });
        }
        Ok(Self { kind, strength })
    }

    /// Whether the condition moves points. If not, the rows of a rectified pair still correspond.
    pub fn moves(self) -> bool {
        matches!(self.kind, Kind::Rotation | Kind::Scale) && self.strength != self.kind.neutral()
    }

    /// Applies the condition to a picture. The same seed gives the same bytes.
    pub fn apply(self, picture: &Picture, seed: u64) -> Changed {
        let Self { kind, strength } = self;
        let random = || Random::new(seed, kind as u64);
        let Size { width, height } = picture.size();
        let in_place =
            |picture| Changed { picture, map: DAffine2::IDENTITY, visible: Plane::filled((width, height), VISIBLE) };
        let covered = |(picture, visible)| Changed { picture, map: DAffine2::IDENTITY, visible };
        let moved = |map| {
            let (picture, visible) = filter::resample(picture, map, picture.size(), mean(picture));
            Changed { picture, map, visible }
        };
        if strength == kind.neutral() {
            return in_place(picture.clone());
        }
        match kind {
            Kind::Gain => in_place(brightness::gain(picture, strength)),
            Kind::Gamma => in_place(brightness::gamma(picture, strength)),
            Kind::Ramp => in_place(brightness::ramp(picture, strength)),
            Kind::Noise => in_place(brightness::noise(picture, strength, random())),
            Kind::Blur => in_place(filter::gaussian(picture, strength)),
            Kind::Rotation => moved(filter::about_centre(picture.size(), strength, 1.0)),
            Kind::Scale => moved(filter::about_centre(picture.size(), 0.0, strength)),
            Kind::Clutter => covered(cover::clutter(picture, strength, random())),
            Kind::Occlusion => covered(cover::frame(picture, strength, mean(picture))),
        }
    }
}

/// Parses `NAME=STRENGTH`, or `NAME` for the default strength.
impl FromStr for Condition {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (name, strength) = text.split_once('=').map_or((text, None), |(name, value)| (name, Some(value)));
        let bad = |name, value: &str, expected: String| Error::Parameter { name, value: value.into(), expected };
        let Some(kind) = Kind::ALL.into_iter().find(|kind| kind.name() == name) else {
            let names = Kind::ALL.map(Kind::name).join(", ");
            return Err(bad("condition", &format!("'{name}'"), format!("there are only: {names}")));
        };
        let strength = match strength {
            None => kind.usual(),
            Some(value) => value.parse().map_err(|_| {
                bad(kind.name(), value, format!("its strength must be a number, as in {name}={}", kind.usual()))
            })?,
        };
        Self::new(kind, strength)
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.kind.name(), self.strength)
    }
}

/// The value of [`Changed::visible`] where the changed picture shows the original.
pub const VISIBLE: u8 = 255;

/// A changed picture and the ground truth of the change.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// The changed picture, of the same size as the original.
    pub picture: Picture,
    /// Invertible map from pixels of the original to pixels of the changed picture.
    pub map: DAffine2,
    /// Mask of the changed picture: [`VISIBLE`], or 0 where the original is occluded or the pixel lies outside of it.
    pub visible: Plane<u8>,
}

impl Changed {
    /// Whether the changed picture shows a position of the original, in pixels.
    pub fn shows(&self, original: DVec2) -> bool {
        value_at(&self.visible, self.map.transform_point2(original)) == Some(VISIBLE)
    }

    /// Applies several conditions in order; without conditions the picture is unchanged.
    pub fn by(conditions: &[Condition], picture: &Picture, seed: u64) -> Self {
        let Size { width, height } = picture.size();
        let unchanged = Self {
            picture: picture.clone(),
            map: DAffine2::IDENTITY,
            visible: Plane::filled((width, height), VISIBLE),
        };
        conditions.iter().fold(unchanged, |before, condition| before.then(*condition, seed))
    }

    fn then(self, condition: Condition, seed: u64) -> Self {
        let Self { picture, map, visible } = condition.apply(&self.picture, seed);
        let back = map.inverse();
        let both = Plane::from_fn(visible.size(), |x, y| {
            let before = back.transform_point2(DVec2::new(x.into(), y.into()));
            visible.get(x, y).min(value_at(&self.visible, before).unwrap_or(0))
        });
        Self { picture, map: map * self.map, visible: both }
    }
}

/// Value of the pixel that a position lies in; `None` outside the plane.
pub(super) fn value_at<T: Copy>(plane: &Plane<T>, place: DVec2) -> Option<T> {
    let (x, y) = ((place.x + 0.5).floor(), (place.y + 0.5).floor());
    let inside = x >= 0.0 && y >= 0.0 && x < f64::from(plane.width()) && y < f64::from(plane.height());
    inside.then(|| plane.get(x as u32, y as u32))
}

/// Mean colour of a picture, the fill of pixels outside of it: a neutral fill adds little contrast.
fn mean(picture: &Picture) -> [u8; 4] {
    let count = picture.data().len() as u64;
    let mean = |channel: usize| {
        let sum: u64 = picture.data().iter().map(|pixel| u64::from(pixel[channel])).sum();
        ((sum + count / 2) / count) as u8
    };
    [mean(0), mean(1), mean(2), 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32) -> Picture {
        Picture::from_fn((width, height), |x, y| {
            [(x * 7 % 251) as u8, (y * 5 % 253) as u8, ((x * 3) ^ (y * 11)) as u8, 255]
        })
    }

    #[test]
    fn nothing_changes_at_the_neutral_strength() {
        let picture = texture(23, 17);
        for kind in Kind::ALL {
            let changed = Condition::new(kind, kind.neutral()).unwrap().apply(&picture, 1);
            assert_eq!(changed, Changed::by(&[], &picture, 1), "{}", kind.name());
            assert!(changed.picture == picture && changed.map == DAffine2::IDENTITY);
        }
    }

    #[test]
    fn what_moves_points_is_known_beforehand() {
        let picture = texture(23, 17);
        for kind in Kind::ALL {
            for strength in [kind.neutral(), kind.usual()] {
                let condition = Condition::new(kind, strength).unwrap();
                let map = condition.apply(&picture, 1).map;
                assert_eq!(condition.moves(), map != DAffine2::IDENTITY, "{condition}");
            }
        }
    }

    #[test]
    fn the_usual_strength_changes_the_picture_and_the_seed_only_what_is_random() {
        let picture = texture(64, 48);
        for kind in Kind::ALL {
            let condition = Condition::new(kind, kind.usual()).unwrap();
            let changed = condition.apply(&picture, 1);
            assert!(changed.picture != picture && changed.picture.size() == picture.size(), "{}", kind.name());
            assert_eq!(changed, condition.apply(&picture, 1));
            let is_random = matches!(kind, Kind::Noise | Kind::Clutter);
            assert_eq!(changed.picture != condition.apply(&picture, 2).picture, is_random, "{}", kind.name());
        }
    }

    /// The brightness centroid of a spot lands where the map says, to a twentieth of a pixel.
    #[test]
    fn a_marked_place_lands_where_the_map_says() {
        let spot = |x: u32, y: u32| (x.abs_diff(70).pow(2) + y.abs_diff(41).pow(2)) as f64;
        let picture = Picture::from_fn((121, 91), |x, y| [(220.0 * (-spot(x, y) / 8.0).exp()) as u8, 0, 0, 255]);
        for text in
            ["rotation=17.5", "rotation=-45", "rotation=90", "scale=0.5", "scale=0.77", "scale=2", "blur=2", "gain=0.5"]
        {
            let changed = text.parse::<Condition>().unwrap().apply(&picture, 1);
            // The fill is not black.
            let ground = f64::from(mean(&picture)[0]);
            let (mut sum, mut moment) = (0.0, DVec2::ZERO);
            for y in 0..91 {
                for x in 0..121 {
                    let value = f64::from(changed.picture.get(x, y)[0]);
                    if changed.visible.get(x, y) == VISIBLE && value > ground + 2.0 {
                        sum += value;
                        moment += value * DVec2::new(x.into(), y.into());
                    }
                }
            }
            let place = changed.map.transform_point2(DVec2::new(70.0, 41.0));
            assert!((moment / sum - place).length() < 0.05, "{text}: {} instead of {place}", moment / sum);
            assert_eq!(value_at(&changed.visible, place), Some(VISIBLE));
            assert!((changed.map.inverse().transform_point2(place) - DVec2::new(70.0, 41.0)).length() < 1e-12);
        }
    }

    #[test]
    fn what_is_in_front_is_not_visible_and_the_rest_is_as_before() {
        let picture = texture(80, 60);
        for kind in [Kind::Clutter, Kind::Occlusion] {
            let changed = Condition::new(kind, 0.4).unwrap().apply(&picture, 9);
            let hidden = changed.visible.data().iter().filter(|&&v| v == 0).count();
            assert!((1500..3500).contains(&hidden), "{hidden}");
            for ((before, after), &visible) in
                picture.data().iter().zip(changed.picture.data()).zip(changed.visible.data())
            {
                assert!(visible == 0 || before == after);
            }
        }
    }

    #[test]
    fn changes_in_a_row_chain_their_maps_and_masks() {
        let picture = texture(60, 60);
        let conditions: Vec<Condition> =
            ["occlusion=0.5", "rotation=90", "scale=0.5"].map(|c| c.parse().unwrap()).into();
        let changed = Changed::by(&conditions, &picture, 1);
        // The centre is (29.5, 29.5): (39.5, 29.5) rotates to (29.5, 39.5) and scales to (29.5, 34.5).
        let place = changed.map.transform_point2(DVec2::new(39.5, 29.5));
        assert!((place - DVec2::new(29.5, 34.5)).length() < 1e-12, "{place}");
        let shown = changed.visible.data().iter().filter(|&&v| v == VISIBLE).count();
        assert_eq!(shown, 15 * 15, "a quarter of the sides of 60");
        assert_eq!(value_at(&changed.visible, place), Some(VISIBLE));
    }

    /// FNV-1a hash of all bytes of all conditions, which must be equal on every machine.
    #[test]
    fn changed_pictures_are_the_same_bytes_everywhere() {
        let picture = texture(64, 48);
        let changed = Kind::ALL.map(|kind| Condition::new(kind, kind.usual()).unwrap().apply(&picture, 1));
        let bytes = changed.iter().flat_map(|changed| changed.picture.rgba().iter().chain(changed.visible.data()));
        let hash =
            bytes.fold(0xcbf2_9ce4_8422_2325u64, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
        assert_eq!(hash, 0x7b65_594b_715c_07e9, "{hash:#x}");
    }

    #[test]
    fn conditions_are_named_with_or_without_their_strength() {
        assert_eq!("noise".parse::<Condition>().unwrap().to_string(), "noise=10");
        assert_eq!("scale=0.75".parse::<Condition>().unwrap(), Condition::new(Kind::Scale, 0.75).unwrap());
        for (text, expected) in [
            ("fog", "condition is 'fog', but there are only: gain, gamma"),
            ("scale=3", "scale is 3, but its strength must be 0.5 to 2"),
            ("noise=NaN", "noise is NaN"),
            ("blur=much", "blur is much, but its strength must be a number, as in blur=1.5"),
        ] {
            let error = text.parse::<Condition>().unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
