//! The cases of the folder, and what must hold for each.

/// A folder with a pair, or with one file that has both views, and what must hold for its run.
pub struct Case {
    pub folder: &'static str,
    pub args: &'static [&'static str],
    pub code: i32,
    /// What the program must say, and what it must not.
    pub told: &'static [&'static str],
    pub untold: &'static [&'static str],
    /// Smallest and largest disparity that the range must hold, and ends within which it must lie.
    pub holds: Option<[i32; 2]>,
    pub within: Option<[i32; 2]>,
    /// Number of black corners of the left view, where nothing may be found.
    pub black_corners: usize,
    /// Largest share of the pixels that may be wrong by over 2 px, 0 to 1.
    pub wrong: f64,
}

const MATCHED: Case = Case {
    folder: "",
    args: &[],
    code: 0,
    told: &[],
    untold: &[],
    holds: None,
    within: None,
    black_corners: 0,
    wrong: 1.0,
};
const DOUBTED: Case = Case { code: 4, ..MATCHED };

pub const CASES: &[Case] = &[
    Case {
        folder: "bayer",
        told: &["both views are raw Bayer mosaics"],
        within: Some([0, 70]),
        wrong: 0.13,
        ..MATCHED
    },
    Case { folder: "black-borders", black_corners: 2, within: Some([-24, 36]), ..MATCHED },
    Case {
        folder: "cloud-25-km",
        args: &["--focal", "721.54", "--baseline", "0.54"],
        holds: Some([5, 41]),
        within: Some([0, 60]),
        ..MATCHED
    },
    Case { folder: "fence-bars", within: Some([-8, 90]), ..DOUBTED },
    Case {
        folder: "lens-distortion",
        told: &["the lens distorts the pictures", "rectified from its matches"],
        holds: Some([7, 53]),
        within: Some([0, 80]),
        ..MATCHED
    },
    Case { folder: "mpo-3d-camera", untold: &["warning"], holds: Some([15, 52]), within: Some([0, 80]), ..MATCHED },
    Case { folder: "no-parallax", told: &["the views show no parallax"], ..DOUBTED },
    Case { folder: "one-row-off", untold: &["warning"], within: Some([0, 78]), wrong: 0.05, ..MATCHED },
    Case { folder: "photo-refused", holds: Some([-19, 8]), within: Some([-40, 32]), ..MATCHED },
    Case { folder: "plain-wall", holds: Some([20, 20]), ..DOUBTED },
    Case { folder: "range-defocus-curved", within: Some([0, 80]), ..DOUBTED },
    Case { folder: "range-own-scene-weak", within: Some([8, 70]), wrong: 0.07, ..MATCHED },
    Case { folder: "range-tiled-wall", ..DOUBTED },
    Case { folder: "round-mask", black_corners: 4, holds: Some([25, 66]), within: Some([0, 90]), ..DOUBTED },
    Case { folder: "satellite-16-bit", holds: Some([-31, -4]), within: Some([-40, 8]), ..MATCHED },
    Case {
        folder: "side-by-side",
        args: &["--side-by-side", "left-right"],
        untold: &["warning"],
        holds: Some([15, 52]),
        within: Some([0, 80]),
        ..MATCHED
    },
    Case { folder: "thermal-16-bit", untold: &["warning"], holds: Some([14, 51]), within: Some([0, 70]), ..MATCHED },
    Case {
        folder: "upside-down-right",
        told: &["turn the right view by 180 degrees", "rectified from its matches"],
        ..MATCHED
    },
    Case {
        folder: "vertical-stereo",
        told: &["the cameras stand above each other: turn both views by 90 degrees", "rectified from its matches"],
        untold: &["clockwise", "larger", "smaller"],
        ..MATCHED
    },
    Case { folder: "wrong-advice", untold: &["lower --min-disparity", "an end of the range"], ..DOUBTED },
];

/// Calibration files for a pair of 340x255 pixels, each with the difference of the principal points that is read from it, in
/// pixels, or words of its refusal.
pub const CALIBRATIONS: [(&str, Result<f64, &str>); 13] = [
    ("K.txt", Err("lies outside the pictures of 340x255")),
    ("commas.txt", Ok(0.0)),
    ("contradict.txt", Err("doffs is '0', but it must be 12")),
    ("full.txt", Err("the calibration is for pictures of 680x510 pixels")),
    ("fxfy.txt", Ok(0.0)),
    ("kitti.txt", Err("lies outside the pictures of 340x255")),
    ("metres.txt", Err("for metres write baseline=100")),
    ("neg.txt", Err("it must be a distance in mm above 0")),
    ("nodoffs.txt", Ok(0.0)),
    ("opencv.yml", Err("there is no M2")),
    ("ros.yaml", Err("name the files of the left and of the right one")),
    ("semis.txt", Ok(12.0)),
    ("spaces.txt", Ok(12.0)),
];
