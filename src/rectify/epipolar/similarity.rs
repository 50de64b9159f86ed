//! Turn and scale between two views.

use glam::DVec2;

use crate::rectify::Correspondence;

/// Turn of the right view against the left, in radians, clockwise on the screen, and its scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Similarity {
    pub turn: f64,
    pub scale: f64,
}

impl Similarity {
    /// The similarity that brings the left points closest to the right ones, in the sense of least squares (Umeyama, IEEE PAMI
    /// 13, 1991).
    pub fn between(points: &[Correspondence]) -> Self {
        let count = points.len().max(1) as f64;
        let mean = |of: fn(&Correspondence) -> DVec2| points.iter().map(of).sum::<DVec2>() / count;
        let (left_mean, right_mean) = (mean(|point| point.left), mean(|point| point.right));
        let (mut along, mut across, mut spread) = (0.0, 0.0, 0.0);
        for Correspondence { left, right } in points {
            let (left, right) = (*left - left_mean, *right - right_mean);
            along += left.dot(right);
            across += left.perp_dot(right);
            spread += left.length_squared();
        }
        let scale = along.hypot(across) / spread;
        let known = scale.is_finite() && scale > 0.0;
        if known { Self { turn: libm::atan2(across, along), scale } } else { Self { turn: 0.0, scale: 1.0 } }
    }
}
