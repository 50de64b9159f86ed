//! The matching cost with threads across disparities: the same as by [`cost`](super::cost()).

pub use super::cost::cost as lane_cost;
