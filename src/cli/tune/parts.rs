//! What can be chosen: stages that have several kernels.

use std::time::Duration;

use hsad::{
    Preset,
    gpu::{Exchange, SgmPlan, Shapes, Windows},
};

/// Stages that are chosen for together.
pub struct Part {
    pub name: &'static str,
    /// The stages, by the names of their kernels without `lane_` and `tile_`.
    stages: &'static [&'static str],
    /// The preset that runs them.
    pub preset: Preset,
    /// What can be chosen, from the choice so far: the name of each, and the shapes.
    pub candidates: fn(Shapes) -> Vec<(String, Shapes)>,
}

impl Part {
    /// The sum of the times of the part's kernels, in milliseconds.
    pub fn milliseconds(&self, kernels: &[(&str, Duration)]) -> f64 {
        let is_of_part = |kernel: &str| {
            let stage = ["lane_", "tile_"].iter().find_map(|shape| kernel.strip_prefix(shape)).unwrap_or(kernel);
            self.stages.contains(&stage)
        };
        let of_part = kernels.iter().filter(|(kernel, _)| is_of_part(kernel));
        1e3 * of_part.map(|(_, time)| time.as_secs_f64()).sum::<f64>()
    }
}

/// All parts, that with the most candidates last.
pub const PARTS: [Part; 5] = [
    Part {
        name: "block matching",
        stages: &["block_match"],
        preset: Preset::Fast,
        candidates: |shapes| windows(|block_match| Shapes { block_match, ..shapes }),
    },
    Part {
        name: "census",
        stages: &["census"],
        preset: Preset::Balanced,
        candidates: |shapes| windows(|census| Shapes { census, ..shapes }),
    },
    Part {
        name: "support",
        stages: &["support"],
        preset: Preset::Balanced,
        candidates: |shapes| windows(|support| Shapes { support, ..shapes }),
    },
    Part {
        name: "weighted median",
        stages: &["weighted_median"],
        preset: Preset::Balanced,
        candidates: |shapes| windows(|weighted_median| Shapes { weighted_median, ..shapes }),
    },
    Part {
        name: "semi-global matching",
        stages: &["cost", "path", "select"],
        preset: Preset::Balanced,
        candidates: |shapes| {
            let lines = ("lines".into(), Shapes { sgm: SgmPlan::Lines, ..shapes });
            let mut candidates = vec![lines];
            for lane_disparities in Shapes::LANE_DISPARITIES {
                for lane_threads in Shapes::LANE_THREADS {
                    for exchange in Exchange::ALL {
                        let name = format!("lanes, {lane_disparities} disparities, {lane_threads} threads, {exchange}");
                        let lanes = Shapes { sgm: SgmPlan::Lanes, lane_disparities, lane_threads, exchange, ..shapes };
                        candidates.push((name, lanes));
                    }
                }
            }
            candidates
        },
    },
];

fn windows(of: impl Fn(Windows) -> Shapes) -> Vec<(String, Shapes)> {
    Windows::ALL.map(|windows| (windows.to_string(), of(windows))).into()
}
