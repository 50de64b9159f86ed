//! Detection and description of interest points on the CPU.

use rayon::prelude::*;

use crate::{
    cpu::features::{
        descriptor::descriptor,
        haar::QuantizedPoint,
        hessian::Octave,
        integral::IntegralImage,
        nonmax::{Candidate, Extremum, candidates, integer_threshold, locate},
        orientation::orientation,
    },
    error::Result,
    features::{
        Detected, Feature, FeatureConfig,
        strongest::{Ranked, strongest},
    },
    image::Luma,
};

/// Finds and describes the interest points of a picture, sorted by octave, interval, row and column; of more than
/// `max_features` the strongest, spread over the picture.
///
/// A picture too small for the filters has no interest points.
///
/// # Errors
/// [`crate::Error::Parameter`] if `config` is refused by [`FeatureConfig::validate`].
pub fn detect(luma: &Luma, config: &FeatureConfig) -> Result<Detected> {
    config.validate()?;
    let integral = IntegralImage::new(luma);
    let extrema = extrema(&integral, config);
    let ranked = |&(Candidate { octave, j, i, .. }, Extremum { response, .. })| {
        let spacing = config.step << octave;
        Ranked { x: i * spacing, y: j * spacing, response }
    };
    let ranked: Vec<Ranked> = extrema.iter().map(ranked).collect();
    let kept = strongest(&ranked, luma.size(), config.max_features as usize);
    let features = kept.into_par_iter().map(|index| feature(&integral, extrema[index].1, config.upright)).collect();
    Ok(Detected { features, found: extrema.len() })
}

/// All interest points with the samples that they were found at.
fn extrema(integral: &IntegralImage, config: &FeatureConfig) -> Vec<(Candidate, Extremum)> {
    let threshold = integer_threshold(config.threshold);
    let octave_extrema = |index| {
        let octave = Octave::new(integral, index, config.step);
        let candidates = candidates(&octave, integral.width(), integral.height(), threshold);
        candidates.into_iter().map(|candidate| (candidate, locate(&octave, candidate))).collect::<Vec<_>>()
    };
    (0..config.octaves).flat_map(octave_extrema).collect()
}

fn feature(integral: &IntegralImage, at: Extremum, upright: bool) -> Feature {
    let Extremum { x, y, scale, response, dark } = at;
    let point = QuantizedPoint::new(x, y, scale);
    let orientation = (!upright).then(|| orientation(integral, point));
    let descriptor = descriptor(integral, point, orientation);
    Feature { x, y, scale, response, dark, orientation: orientation.unwrap_or(0.0), descriptor }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blobs of several sizes on a grid, light and dark.
    fn blobs(width: u32, height: u32) -> Luma {
        Luma::from_fn((width, height), |x, y| {
            let (column, row) = (x / 40, y / 40);
            let (dx, dy) = ((x % 40) as f32 - 20.0 + row as f32, (y % 40) as f32 - 20.0);
            let sigma = 2.5 + 0.5 * column as f32;
            let sign = if (column + row) % 2 == 0 { 1.0 } else { -1.0 };
            (128.0 + sign * 90.0 * (-(dx * dx + 0.6 * dy * dy + 0.3 * dx * dy) / (2.0 * sigma * sigma)).exp()) as u8
        })
    }

    #[test]
    fn features_are_valid_and_described() {
        let Detected { features, found } =
            detect(&blobs(200, 160), &FeatureConfig { upright: false, ..Default::default() }).unwrap();
        assert_eq!(found, features.len());
        assert!(features.len() >= 20);
        for feature in &features {
            let length: f32 = feature.descriptor.iter().map(|value| value * value).sum();
            assert!((length - 1.0).abs() < 1e-5);
            assert!((0.0..std::f32::consts::TAU).contains(&feature.orientation));
            assert!((0.0..200.0).contains(&feature.x) && (0.0..160.0).contains(&feature.y) && feature.scale > 1.0);
        }
    }

    #[test]
    fn upright_features_are_not_turned() {
        let features = detect(&blobs(200, 160), &FeatureConfig::default()).unwrap().features;
        assert!(features.iter().all(|feature| feature.orientation == 0.0));
    }

    #[test]
    fn flat_and_tiny_pictures_have_none() {
        for (width, height) in [(1, 1), (3, 200), (200, 3), (200, 200)] {
            let flat = detect(&Luma::filled((width, height), 77), &FeatureConfig::default()).unwrap();
            assert_eq!(flat, Detected::default());
        }
    }

    #[test]
    fn of_too_many_features_the_strongest_are_kept_and_all_are_counted() {
        let picture = blobs(200, 160);
        let limited = |max_features| detect(&picture, &FeatureConfig { max_features, ..Default::default() }).unwrap();
        let Detected { features: all, found } = limited(65_536);
        assert_eq!(limited(found as u32).features, all);
        // One cell of 8 * 200 * 160 / (found - 1) square pixels loses its weakest point.
        let fewer = limited(found as u32 - 1);
        assert_eq!((fewer.features.len(), fewer.found), (found - 1, found));
        let ordered = all.iter().filter(|feature| fewer.features.contains(feature));
        assert!(ordered.eq(&fewer.features));
        let response = |features: &[Feature]| features.iter().map(|feature| feature.response).fold(0.0, f32::max);
        assert_eq!(limited(1).features.len(), 1);
        assert_eq!(limited(1).features[0].response, response(&all));
    }

    #[test]
    fn a_config_out_of_range_is_refused() {
        assert!(detect(&blobs(40, 40), &FeatureConfig { octaves: 6, ..Default::default() }).is_err());
    }
}
