//! Hashes of what the twins leave, stored with this crate: a change of the twins, or of what compiles them, is seen
//! even where the kernels change with them.

use super::{
    Extent, cases,
    golden_hash::{STORED, hash, key},
};

/// The whole file as the twins would have it now.
///
/// # Errors
/// Those of a twin.
pub fn current() -> crate::Result<String> {
    let mut text = String::new();
    for case in [Extent::Full, Extent::Quick].into_iter().flat_map(cases) {
        if let Some(hash) = hash(&case.trial().twin()?) {
            text += &format!("{} {hash:016x}\n", key(case.subject.name, case.size, case.seed));
        }
    }
    Ok(text)
}

/// The whole file as it is stored.
pub fn text() -> &'static str {
    STORED
}
