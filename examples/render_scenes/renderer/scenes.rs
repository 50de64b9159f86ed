//! The shipped scenes.

mod curved;
mod planes;
mod weak;

use super::Scene;

/// All shipped scenes.
pub fn scenes() -> Vec<Scene> {
    vec![planes::scene(), curved::scene(), weak::scene()]
}
