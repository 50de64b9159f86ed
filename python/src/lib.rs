//! The extension module `hsad._hsad`: between the library and NumPy. `hsad/__init__.pyi` has the types of everything here.

mod arrays;
mod backend;
mod calibration;
mod encoded;
mod errors;
mod features;
mod files;
mod geometry;
mod matcher;
mod matching;
mod options;
mod rectify;
mod report;
mod scores;
mod tiles;

/// Stereo depth from two photographs, on any GPU.
#[pyo3::pymodule]
mod _hsad {
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use crate::{
        backend::devices,
        calibration::{Calibration, read_calibration},
        encoded::{Encoded, match_encoded},
        features::{Features, features, match_features},
        files::{
            read_disparity, read_image, read_kitti, read_pair, read_pfm, read_ply, write_kitti, write_pfm, write_ply,
            write_png,
        },
        geometry::{depth, points},
        matcher::Matcher,
        matching::{Match, match_pair},
        options::options,
        rectify::{Rectified, rectify},
        scores::{colorize, error_colors, evaluate},
        tiles::{cut_tiles, match_tile, merge_tiles},
    };
}
