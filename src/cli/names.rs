//! The names of files in output folders.

use hsad::report::ResultFile;

/// The file of a set that lists all files of the set.
pub const REPORT: &str = ResultFile::Report.name();

/// A result of an evaluation, which lists the files beside it.
pub const RESULT: &str = "result.json";

/// Drawings of interest points and matches of a pair.
pub const FIGURES: [&str; 2] = ["keypoints.png", "matches.png"];

/// The surfaces of a map.
pub const MESH: &str = "mesh.ply";

/// The table of matches.
pub const MATCHES: &str = "matches.csv";

/// The files of `hsad features` for one picture.
pub const POINTS: [&str; 2] = ["features.csv", FIGURES[0]];

/// The files of `hsad features` for two pictures.
pub const MATCHED_POINTS: [&str; 2] = [MATCHES, FIGURES[1]];

/// What `hsad demo` adds to the files of `hsad match`.
pub const DEMO: [&str; 3] = ["demo.png", "left.png", "right.png"];

/// Errors of a map, alone and beside picture, map and truth.
pub const ERRORS: [&str; 2] = ["error.png", "figure.png"];

/// Curves of `hsad eval paper`, in the order of its figures, as a table and drawn.
pub const CURVES: [[&str; 2]; 4] = [
    ["recall-precision.csv", "recall-precision.svg"],
    ["f-measure.csv", "f-measure.svg"],
    ["accuracy.csv", "accuracy.svg"],
    ["coverage.csv", "coverage.svg"],
];

/// Names of the files of a rectified pair: both pictures, both masks, the figure, matrices as JSON and for OpenCV.
pub struct Rectified {
    pub pictures: [&'static str; 2],
    pub masks: [&'static str; 2],
    pub figure: &'static str,
    pub json: &'static str,
    pub yaml: &'static str,
}

/// The files of `hsad rectify`.
pub const RECTIFIED: Rectified = Rectified {
    pictures: ["left.png", "right.png"],
    masks: ["left-mask.png", "right-mask.png"],
    figure: "epipolar-lines.png",
    json: "rectification.json",
    yaml: "rectification.yml",
};

/// The files of a pair that was rectified before it was matched.
pub const RECTIFIED_FIRST: Rectified = Rectified {
    pictures: ["rectified-left.png", "rectified-right.png"],
    masks: ["rectified-left-mask.png", "rectified-right-mask.png"],
    ..RECTIFIED
};

impl Rectified {
    /// All names.
    pub fn all(&self) -> [&'static str; 7] {
        let Self { pictures: [left, right], masks: [left_mask, right_mask], figure, json, yaml } = *self;
        [left, right, left_mask, right_mask, figure, json, yaml]
    }
}

/// Whether a run of hsad writes files of this name to sets of results.
pub fn is_ours(name: &str) -> bool {
    let maps = ResultFile::ALL.map(ResultFile::name);
    let rectified = [RECTIFIED.all(), RECTIFIED_FIRST.all()].concat();
    let lists: [&[&str]; 9] = [
        &maps,
        &rectified,
        &FIGURES,
        &POINTS,
        &MATCHED_POINTS,
        &DEMO,
        &ERRORS,
        CURVES.as_flattened(),
        &[REPORT, RESULT, MESH, MATCHES],
    ];
    lists.concat().contains(&name)
}
