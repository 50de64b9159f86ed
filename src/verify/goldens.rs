//! Hashes of the twins' outputs, stored with this crate: they reveal a change of the twins, or of their compiler, even
//! where the kernels change in the same way.

use super::{
    Extent, cases,
    golden_hash::{STORED, hash, key},
};

/// The contents of the file by the present twins.
///
/// # Errors
/// The errors of a twin.
pub fn current() -> crate::Result<String> {
    let mut text = String::new();
    for case in [Extent::Full, Extent::Quick].into_iter().flat_map(cases) {
        if let Some(hash) = hash(&case.trial().twin()?) {
            text += &format!("{} {hash:016x}\n", key(case.subject.name, case.size, case.seed));
        }
    }
    Ok(text)
}

/// The stored file.
pub fn text() -> &'static str {
    STORED
}
