//! The scenes that are shipped.

mod curved;
mod planes;
mod weak;

use super::Scene;

/// All of them.
pub fn scenes() -> Vec<Scene> {
    vec![planes::scene(), curved::scene(), weak::scene()]
}
