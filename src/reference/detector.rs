//! The whole sparse half on the CPU: a picture in, interest points out.

use rayon::prelude::*;

use crate::{
    error::{Error, Result},
    features::{Feature, FeatureConfig},
    image::Luma,
    reference::{
        descriptor::describe,
        hessian::Octave,
        integral::IntegralImage,
        nonmax::{Extremum, candidates, integer_threshold, locate},
        orientation::orientation,
    },
};

/// Finds and describes the interest points of a picture, by octave, interval, row and column.
///
/// A picture too small for the filters has none.
///
/// # Errors
/// [`Error::Parameter`] if `config` is refused by [`FeatureConfig::validate`], or if there are more
/// than `max_features` points.
pub fn detect(luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
    config.validate()?;
    let integral = IntegralImage::new(luma);
    let extrema = extrema(&integral, config);
    if extrema.len() > config.max_features as usize {
        return Err(Error::Parameter {
            name: "max_features",
            value: config.max_features.to_string(),
            expected: format!("this picture has {} interest points: allow as many, or raise threshold", extrema.len()),
        });
    }
    Ok(extrema.into_par_iter().map(|extremum| feature(&integral, extremum, config.upright)).collect())
}

fn extrema(integral: &IntegralImage, config: &FeatureConfig) -> Vec<Extremum> {
    let threshold = integer_threshold(config.threshold);
    let octave_extrema = |index| {
        let octave = Octave::new(integral, index, config.step);
        let candidates = candidates(&octave, integral.width(), integral.height(), threshold);
        candidates.into_iter().filter_map(|candidate| locate(&octave, candidate)).collect::<Vec<_>>()
    };
    (0..config.octaves).flat_map(octave_extrema).collect()
}

fn feature(integral: &IntegralImage, at: Extremum, upright: bool) -> Feature {
    let Extremum { x, y, scale, response, dark } = at;
    let orientation = if upright { 0.0 } else { orientation(integral, x, y, scale) };
    let descriptor = describe(integral, x, y, scale, orientation);
    Feature { x, y, scale, response, dark, orientation, descriptor }
}
