//! What was not seen in a picture, as the user knows it: masks, and a value for missing data.

use std::path::{Path, PathBuf};

use super::{
    codec, malformed,
    samples::{Kind, Samples},
};
use crate::error::{Error, Result, shown};

/// Pixels of a pair that were not seen, besides those of alpha 0 and those of samples that are not finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unseen {
    /// Mask of the left and of the right view: a picture of the size that the view has after its EXIF orientation; 0 in
    /// all channels, or alpha 0, stands for 'not seen'.
    pub masks: [Option<PathBuf>; 2],
    /// A pixel whose samples, without alpha, all equal this value was not seen. The unit is the file's, before any
    /// stretch; NaN adds nothing, since samples that are not finite are never seen.
    pub nodata: Option<f32>,
}

impl Unseen {
    /// The files of the masks.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.masks.iter().filter_map(Option::as_deref)
    }

    /// Checks that a view of one of `kinds` can have the value for missing data.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if none can.
    pub(super) fn check(&self, kinds: [Kind; 2]) -> Result<()> {
        let Some(value) = self.nodata.filter(|value| value.is_finite()) else { return Ok(()) };
        let occurs = |most: f32| (0.0..=most).contains(&value) && value.fract() == 0.0;
        // The wider kind has the values of the other one.
        let most = kinds.map(Kind::largest).into_iter().reduce(|a, b| Some(a?.max(b?))).flatten();
        match most {
            Some(most) if !occurs(most) => Err(Error::Parameter {
                name: "nodata",
                value: value.to_string(),
                expected: format!(
                    "samples of these pictures are whole numbers from 0 to {most}: name one of them, or none"
                ),
            }),
            _ => Ok(()),
        }
    }

    /// Makes pixels of a view, the one in `path`, unseen.
    ///
    /// # Errors
    /// [`crate::Error::Format`] if no pixel is left, or the mask has another size or is no picture;
    /// [`crate::Error::Io`] if the mask cannot be read.
    pub(super) fn hide(&self, view: &mut Samples, mask: Option<&Path>, path: &Path) -> Result<()> {
        if let Some(value) = self.nodata {
            view.hide_value(value);
            if !view.is_seen() {
                let reason =
                    format!("all its pixels have the value for missing data, {value}: name another one or none");
                return Err(malformed(path, reason));
            }
        }
        let Some(mask_path) = mask else { return Ok(()) };
        let mask = Samples::new(codec::decode(&codec::read_bytes(mask_path)?, mask_path)?);
        if mask.size() != view.size() {
            let (size, found) = (view.size(), mask.size());
            let reason = format!("the mask is {found} and its view, {}, {size} pixels: they must agree", shown(path));
            return Err(malformed(mask_path, reason));
        }
        view.hide_outside(&mask);
        if !view.is_seen() {
            let reason =
                format!("the mask leaves no pixel of {}: it must not be 0 where the view is valid", shown(path));
            return Err(malformed(mask_path, reason));
        }
        Ok(())
    }
}
