//! Noise and blur: nothing moves.

use super::{brightness::grey, random::Random};
use crate::{image::Plane, io::Picture};

/// Normal noise of `deviation` grey levels in each colour of each pixel, independently.
pub(super) fn noise(picture: &Picture, deviation: f64, mut random: Random) -> Picture {
    picture.map(|&[red, green, blue, alpha]| {
        let [red, green, blue] = [red, green, blue].map(|value| grey(f64::from(value) + deviation * random.normal()));
        [red, green, blue, alpha]
    })
}

/// A Gaussian of standard deviation `sigma` px, cut at three of them; beyond the edge its pixels go on.
pub(super) fn blur(picture: &Picture, sigma: f64) -> Picture {
    if sigma == 0.0 {
        return picture.clone();
    }
    let reach = (3.0 * sigma).ceil() as i64;
    let weight = |i: i64| libm::exp(-((i * i) as f64) / (2.0 * sigma * sigma));
    let total: f64 = (-reach..=reach).map(weight).sum();
    let weights: Vec<(i64, f64)> = (-reach..=reach).map(|i| (i, weight(i) / total)).collect();

    type Colour = [f64; 3];
    let sum = |at: &dyn Fn(i64) -> Colour| {
        weights.iter().fold([0.0; 3], |sum: Colour, &(i, weight)| {
            let colour = at(i);
            std::array::from_fn(|k| sum[k] + weight * colour[k])
        })
    };
    let (width, height) = picture.size();
    let along_rows: Plane<Colour> = Plane::from_fn(width, height, |x, y| {
        sum(&|i| {
            let [red, green, blue, _] = picture.get_clamped(i64::from(x) + i, y.into());
            [red, green, blue].map(f64::from)
        })
    });
    Picture::from_fn(width, height, |x, y| {
        let [red, green, blue] = sum(&|i| along_rows.get_clamped(x.into(), i64::from(y) + i)).map(grey);
        [red, green, blue, picture.get(x, y)[3]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_deviation_asked_for() {
        let flat = Picture::filled(100, 100, [128, 128, 128, 255]);
        let noisy = noise(&flat, 10.0, Random::new(1, 1));
        let squares: f64 = noisy.data().iter().map(|pixel| (f64::from(pixel[1]) - 128.0).powi(2)).sum();
        assert!(((squares / 10_000.0).sqrt() - 10.0).abs() < 0.3);
        assert!(noisy.data().iter().any(|pixel| pixel[0] != pixel[1]), "colours are independent");
    }

    #[test]
    fn a_point_becomes_a_gaussian() {
        let mut point = Picture::filled(41, 41, [0, 0, 0, 255]);
        point.set(20, 20, [255; 4]);
        let blurred = blur(&point, 1.0);
        // 255 / (2 pi) = 40.6, with exp(-1/2) and exp(-1) of it beside and diagonally.
        let [middle, beside, diagonal] = [(20, 20), (21, 20), (19, 19)].map(|(x, y)| blurred.get(x, y)[0]);
        assert!(middle.abs_diff(41) <= 1 && beside.abs_diff(25) <= 1 && diagonal.abs_diff(15) <= 1);
        let flat = Picture::filled(9, 5, [7, 77, 177, 1]);
        assert_eq!(blur(&flat, 2.5), flat);
    }
}
