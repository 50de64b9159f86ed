//! Matching as `hsad match` does, and its exit code.

use hsad::{
    Backend, Config, Error,
    eval::scene::Scene,
    pipeline::{self, Outcome, TRUSTED},
};

use crate::AnyError;

/// A map and the exit code of `hsad match`.
pub struct Matched {
    /// Results of the pipeline; for a refused pair those of the pair matched all the same.
    pub outcome: Outcome,
    /// 0 for a map to be trusted, 3 for a pair refused as not rectified, 4 for a map not to be trusted.
    pub exit_code: u8,
}

/// Matches a scene; a pair that is refused as not rectified is matched all the same, to see the map.
pub fn matched(backend: &Backend, scene: &Scene, config: &Config) -> Result<Matched, AnyError> {
    let run = |force| {
        let config = Config { force, ..config.clone() };
        pipeline::run(backend, (&scene.left, &scene.right), &config, |_| ())
    };
    match run(false) {
        Ok(outcome) => {
            let is_trusted = outcome.trust >= TRUSTED;
            Ok(Matched { outcome, exit_code: if is_trusted { 0 } else { 4 } })
        }
        Err(Error::NotRectified { .. }) => Ok(Matched { outcome: run(true)?, exit_code: 3 }),
        Err(error) => Err(error.into()),
    }
}
