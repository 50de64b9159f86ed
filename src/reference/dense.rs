//! The dense half in one call.

use super::{block_match, check_consistency, winners};
use crate::{
    dense::{Dense, DenseConfig},
    error::{Error, Result},
    image::Luma,
};

/// What [`crate::dense::compute`] computes, on the CPU.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`].
pub fn compute_dense(left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    config.validate()?;
    let config = DenseConfig { range: config.searched(left.width())?, ..config.clone() };
    let mut dense = block_match(left, right, config.reference, &config);
    if let Some(max_difference) = config.consistency {
        let others = winners(left, right, config.reference.other(), &config);
        check_consistency(&mut dense, config.reference, &others, max_difference);
    }
    Ok(dense)
}
