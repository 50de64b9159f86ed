//! Changes of brightness, pixel by pixel, without moving anything.

use super::random::Random;
use crate::{filter::grey, io::Picture};

/// Applies `f(column, value)` to each colour value; the result is rounded (halves up) and clamped to 0 to 255.
fn each(picture: &Picture, f: impl Fn(u32, u8) -> f64) -> Picture {
    Picture::from_fn(picture.size(), |x, y| {
        let [red, green, blue, alpha] = picture.get(x, y);
        let [red, green, blue] = [red, green, blue].map(|value| grey(f(x, value)));
        [red, green, blue, alpha]
    })
}

/// Multiplies every colour value by `factor`.
pub(super) fn gain(picture: &Picture, factor: f64) -> Picture {
    each(picture, |_, value| factor * f64::from(value))
}

/// Replaces every colour value `v` by `255 (v / 255)^exponent`.
pub(super) fn gamma(picture: &Picture, exponent: f64) -> Picture {
    let curve: Vec<f64> = (0..=255).map(|value| 255.0 * libm::pow(f64::from(value) / 255.0, exponent)).collect();
    each(picture, |_, value| curve[usize::from(value)])
}

/// Multiplies colour values by a factor that grows linearly from `1 - strength` in the first column to `1 + strength`
/// in the last one.
pub(super) fn ramp(picture: &Picture, strength: f64) -> Picture {
    let last = f64::from(picture.width() - 1).max(1.0);
    each(picture, |x, value| (1.0 + strength * (2.0 * f64::from(x) / last - 1.0)) * f64::from(value))
}

/// Adds normal noise with a standard deviation of `deviation` grey levels, independent in each colour of each pixel.
pub(super) fn noise(picture: &Picture, deviation: f64, mut random: Random) -> Picture {
    picture.map(|&[red, green, blue, alpha]| {
        let [red, green, blue] = [red, green, blue].map(|value| grey(f64::from(value) + deviation * random.normal()));
        [red, green, blue, alpha]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        Picture::new((3, 1), vec![[0, 100, 255, 7], [51, 200, 3, 0], [10, 20, 30, 255]]).unwrap()
    }

    #[test]
    fn by_hand() {
        assert_eq!(gain(&picture(), 1.5).data(), [[0, 150, 255, 7], [77, 255, 5, 0], [15, 30, 45, 255]]);
        // (51 / 255)^2 = 0.04: 10.2; (100 / 255)^2 = 0.1538: 39.2.
        let darker = gamma(&picture(), 2.0);
        assert_eq!((darker.get(0, 0), darker.get(1, 0)[0]), ([0, 39, 255, 7], 10));
        // Factors 0.5, 1 and 1.5.
        assert_eq!(ramp(&picture(), 0.5).data(), [[0, 50, 128, 7], [51, 200, 3, 0], [15, 30, 45, 255]]);
    }

    #[test]
    fn noise_has_the_deviation_asked_for() {
        let flat = Picture::filled((100, 100), [128, 128, 128, 255]);
        let noisy = noise(&flat, 10.0, Random::new(1, 1));
        let squares: f64 = noisy.data().iter().map(|pixel| (f64::from(pixel[1]) - 128.0).powi(2)).sum();
        assert!(((squares / 10_000.0).sqrt() - 10.0).abs() < 0.3);
        assert!(noisy.data().iter().any(|pixel| pixel[0] != pixel[1]), "colours are independent");
    }
}
