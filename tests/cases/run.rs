//! One run of `hsad match`, and what is asked of every run.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hsad::{
    disparity::{self, DisparityMap, DisparityRange},
    eval::{self, Bad},
    image::Plane,
    io::{load, pfm},
    pipeline::TRUSTED,
};
use serde_json::Value;
use tempfile::TempDir;

/// What a run left behind.
pub struct Run {
    /// Exit code.
    pub code: i32,
    /// Standard error.
    pub told: String,
    folder: TempDir,
}

impl Run {
    /// `hsad match LEFT RIGHT -o FOLDER ARGS`.
    pub fn of(left: &Path, right: &Path, args: &[&str]) -> Self {
        Self::of_files(&[left, right], args)
    }

    /// `hsad match FILES -o FOLDER ARGS`.
    pub fn of_files(files: &[&Path], args: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut command = assert_cmd::cargo::cargo_bin_cmd!("hsad");
        command.env_remove("RUST_LOG").arg("match").args(files).arg("-o").arg(folder.path()).args(args);
        let output = command.output().expect("the program starts");
        let told = String::from_utf8(output.stderr).expect("UTF-8");
        Self { code: output.status.code().expect("an exit code"), told, folder }
    }

    /// The run, which must have ended with `code` and said all of `words`.
    #[track_caller]
    pub fn ends(self, code: i32, words: &[&str]) -> Self {
        assert_eq!(self.code, code, "{}", self.told);
        for words in words {
            assert!(self.told.contains(words), "'{words}' is not in: {}", self.told);
        }
        self
    }

    /// The run, which must have said none of `words`.
    #[track_caller]
    pub fn never_says(self, words: &[&str]) -> Self {
        for words in words {
            assert!(!self.told.contains(words), "'{words}' is in: {}", self.told);
        }
        self
    }

    pub fn has(&self, file: &str) -> bool {
        self.folder.path().join(file).exists()
    }

    pub fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    pub fn report(&self) -> Value {
        serde_json::from_slice(&self.bytes("report.json")).expect("JSON")
    }

    pub fn trust(&self) -> f64 {
        self.report()["trust"].as_f64().expect("a number")
    }

    /// The searched range.
    pub fn range(&self) -> DisparityRange {
        let range = &self.report()["range"];
        let [min, max] = ["min", "max"].map(|end| range[end].as_i64().expect("a whole number") as i32);
        DisparityRange::inclusive(min, max).expect("a range")
    }

    pub fn disparity(&self) -> DisparityMap {
        pfm::read_disparities(&self.folder.path().join("disparity.pfm")).expect("a map")
    }

    pub fn confidence(&self) -> Plane<u8> {
        load::load(&self.folder.path().join("confidence.png")).expect("a picture").luma()
    }

    /// Number of points in the point cloud.
    pub fn points(&self) -> usize {
        let bytes = self.bytes("cloud.ply");
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(300)]);
        let count = head.lines().find_map(|line| line.strip_prefix("element vertex "));
        count.expect("a number of points").parse().expect("a number")
    }

    /// Share of the known pixels that are wrong by over 2 px or have no disparity, 0 to 1.
    pub fn wrong(&self, truth: &Plane<f32>) -> f64 {
        self.bad(truth).of_known
    }

    fn bad(&self, truth: &Plane<f32>) -> Bad {
        eval::score(&self.disparity(), truth, None, &[2.0]).expect("maps of one size").bad[0]
    }

    /// Shares of the pixels that are wrong by over 2 px, 0 to 1: of the surer half of the disparities with known truth, and of
    /// those with a confidence of at least 192; NaN where there are none.
    pub fn wrong_of_sure(&self, truth: &Plane<f32>) -> [f64; 2] {
        let (map, confidence) = (self.disparity(), self.confidence());
        let pixels = map.data().iter().zip(confidence.data()).zip(truth.data());
        let known = pixels.filter(|(_, truth)| truth.is_finite());
        let mut judged: Vec<(u8, bool)> = known
            .filter_map(|((&found, &sure), truth)| Some((sure, (disparity::pixels(found)? - truth).abs() > 2.0)))
            .collect();
        // Of equally confident pixels the wrong ones come first, so that ties never help.
        judged.sort_unstable_by(|a, b| b.cmp(a));
        let sure = judged.partition_point(|&(confidence, _)| confidence >= 192);
        [judged.len() / 2, sure].map(|count| {
            let wrong = judged[..count].iter().filter(|(_, wrong)| *wrong).count();
            wrong as f64 / count as f64
        })
    }

    /// What the disparities are larger than the truth by in the median, in pixels, and the share of them that are wrong by over 2 px beside
    /// it, 0 to 1.
    pub fn wrong_but_for_a_constant(&self, truth: &Plane<f32>) -> (f32, f64) {
        let map = self.disparity();
        assert_eq!(map.size(), truth.size());
        let pairs = map.data().iter().zip(truth.data());
        let mut off: Vec<f32> = pairs.filter_map(|(&d, truth)| Some(disparity::pixels(d)? - truth)).collect();
        off.retain(|off| off.is_finite());
        assert!(off.len() * 10 > truth.data().len() * 7, "{} known", off.len());
        off.sort_by(f32::total_cmp);
        let constant = off[off.len() / 2];
        let wrong = off.iter().filter(|&&off| (off - constant).abs() > 2.0).count();
        (constant, wrong as f64 / off.len() as f64)
    }

    /// Why trust is on the wrong side of 0.5, if it is: more than 30 % of the disparities are wrong by over 2 px and
    /// trusted, or fewer than 10 % and not trusted.
    pub fn misjudgement(&self, truth: &Plane<f32>) -> Option<String> {
        let (trust, wrong) = (self.trust(), self.bad(truth).of_estimated);
        let trusted = trust >= f64::from(TRUSTED);
        (trusted && wrong > 0.3 || !trusted && wrong < 0.1).then(|| format!("trust {trust:.2} with {wrong:.3} wrong"))
    }

    /// The run, whose range must hold the truth, but for a part of 0.5 %, and have at most `most` disparities.
    #[track_caller]
    pub fn holds(self, truth: &Plane<f32>, most: u32) -> Self {
        let (range, outside) = (self.range(), self.outside(truth));
        assert!(outside < 0.005, "{outside} of the truth outside of {range:?}");
        assert!(range.count <= most, "{range:?}");
        self
    }

    /// Share of the truth outside of the range, 0 to 1.
    pub fn outside(&self, truth: &Plane<f32>) -> f64 {
        let range = self.range();
        let known = truth.data().iter().filter(|disparity| disparity.is_finite());
        let outside = known.clone().filter(|disparity| !range.contains(disparity.round() as i32));
        outside.count() as f64 / known.count() as f64
    }

    /// The run, whose trust must be on the right side of 0.5; the exit code must be 4 below and 0 above.
    #[track_caller]
    pub fn judges(self, truth: &Plane<f32>) -> Self {
        assert_eq!(self.misjudgement(truth), None, "{}", self.told);
        assert_eq!(self.code, if self.trust() >= f64::from(TRUSTED) { 0 } else { 4 }, "{}", self.told);
        self
    }

    /// The run, of whose map fewer than `most` of the known pixels, 0 to 1, may be wrong by over 2 px.
    #[track_caller]
    pub fn errs_below(self, most: f64, truth: &Plane<f32>) -> Self {
        let wrong = self.wrong(truth);
        assert!(wrong < most, "{wrong} wrong: {}", self.told);
        self
    }

    /// The run, whose map must have neither disparity nor confidence nor colour where `seen` is 0, and disparities in
    /// 90 % of the rest.
    #[track_caller]
    pub fn leaves_out(self, seen: &Plane<u8>) -> Self {
        let (map, confidence) = (self.disparity(), self.confidence());
        let colors = load::load(&self.folder.path().join("disparity-color.png")).expect("a picture");
        let (mut shown, mut known) = (0, 0);
        for (i, &seen) in seen.data().iter().enumerate() {
            let has = map.data()[i] != disparity::NONE;
            if seen == 0 {
                let color = &colors.data()[i][..3];
                assert!(!has && confidence.data()[i] == 0 && color == [0; 3], "pixel {i}: {}", map.data()[i]);
            } else {
                (shown, known) = (shown + 1, known + usize::from(has));
            }
        }
        assert!(known * 10 >= shown * 9, "{known} of {shown} pixels have a disparity");
        self
    }

    fn bytes(&self, file: &str) -> Vec<u8> {
        fs::read(self.folder.path().join(file)).expect("a file of the run")
    }
}
