//! How a pair is matched, and which files come out: what `hsad match` and `hsad batch` share.

use clap::Args;
use hsad::{
    Error,
    config::{Config, Method},
    internals::fnv1a,
    io::{
        load::{self, LoadedPair},
        read_whole,
    },
    pipeline::Geometry,
};
use serde_json::Value;

use super::{
    cloud::CloudOptions,
    depth::{Cameras, DepthOptions},
    job::{CompletedJob, Job},
    names,
    options::{FigureOptions, MatchOptions, UnseenOptions},
    output::Output,
    products, rectification,
    view_files::Views,
    way::Rectify,
};

pub use super::depth::Known;

/// Longest calibration file that is read, in bytes: COLMAP lists every point that a picture shows.
pub const MOST_CALIBRATION: u64 = 1 << 27;

/// How a pair is matched, and which files come out.
#[derive(Args, Clone, Debug)]
pub struct Recipe {
    /// Also draw interest points (keypoints.png) and matches (matches.png)
    #[arg(long)]
    figures: bool,
    /// Also write the matches of the interest points (matches.csv), found in any row: positions, scales and orientations in
    /// both views, distance and ratio of the descriptors, confidence, and 1 where rows agree
    #[arg(long)]
    matches: bool,
    /// Whether and how to rectify the pair before it is matched
    #[arg(long, value_enum, default_value = "auto")]
    rectify: Rectify,
    /// Take the map of a pair that was rectified first back to the left picture as it was taken (with --reference right to
    /// the right one); disparities remain those of the rectified pair
    #[arg(long)]
    map_back: bool,
    #[command(flatten)]
    matching: MatchOptions,
    #[command(flatten)]
    figure: FigureOptions,
    #[command(flatten)]
    depth: DepthOptions,
    #[command(flatten)]
    cloud: CloudOptions,
    #[command(flatten)]
    unseen: UnseenOptions,
}

/// What a pair may have of its own, besides what the options tell of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Own {
    Nothing,
    /// The geometry of pictures that are rectified.
    Geometry,
    /// A calibration of the pictures as they were taken.
    Calibration,
}

/// A job, and doubts about the files that were read for it, which may be the reason why it fails.
pub struct Prepared {
    pub job: Job,
    pub warnings: Vec<String>,
}

impl Recipe {
    /// The configuration, and how many interest points and matches a figure shows.
    ///
    /// # Errors
    /// [`Error::Parameter`], also for options without effect.
    pub fn config(&self) -> hsad::Result<(Config, Option<usize>)> {
        let config = self.matching.config()?;
        let refused =
            |name, expected: &str| Err(Error::Parameter { name, value: "given".into(), expected: expected.into() });
        if self.map_back && self.rectify == Rectify::Never {
            return refused("--map-back", "a pair that is never rectified (--rectify never) has no map to take back");
        }
        if let (true, Method::Hsad(parameters)) = (self.cloud.filled, &config.method)
            && !parameters.refinement.is_some_and(|refinement| refinement.fill)
        {
            return refused("--filled", "no hole is filled with these options: add --fill, or leave it out");
        }
        Ok((config, self.figure.strongest(&self.matching)?))
    }

    /// Whether the options have a calibration of all pairs.
    pub fn has_calibration(&self) -> bool {
        self.depth.are_given()
    }

    /// Checks, before any pair is read, what all pairs have in common: options, calibration files and masks. `own`: what a pair may have of its
    /// own.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that no pair can follow, and those of a file that cannot be read.
    pub fn check_common(&self, own: Own) -> hsad::Result<()> {
        let has_files = self.depth.check_files()?;
        for mask in self.unseen.unseen().files() {
            load::load(mask)?;
        }
        let is_given = self.depth.are_given();
        self.cloud.check(own != Own::Nothing || is_given)?;
        self.rectify.check_known(own == Own::Calibration || has_files, is_given)
    }

    /// All options as text, each file by the hash of its content: what two runs that match pairs alike have in common.
    ///
    /// # Errors
    /// Those of a file that cannot be read.
    pub fn described(&self) -> hsad::Result<String> {
        let mut described = self.clone();
        let named = |bytes: Vec<u8>| format!("{:016x}", fnv1a(bytes)).into();
        for file in described.depth.files_mut() {
            *file = named(read_whole(file, MOST_CALIBRATION)?);
        }
        for file in described.unseen.files_mut() {
            *file = named(load::read(file)?);
        }
        Ok(format!("{described:?}"))
    }

    /// Reads the files of a pair, and checks that its results can be written to `output`.
    pub fn prepare(&self, views: &Views, known: Known<'_>, output: &mut Output) -> anyhow::Result<Prepared> {
        let (config, strongest) = self.config()?;
        let unseen = self.unseen.unseen();
        output.spare(views.paths());
        output.spare(unseen.files());
        let LoadedPair { left, right, stretch, mut warnings } = views.load(&unseen)?;
        let sizes = [left.size(), right.size()];
        warnings.extend(self.matching.without_effect(sizes[0].width.max(sizes[1].width)));
        let known = match known {
            Known::Recorded(_) if self.rectify == Rectify::Uncalibrated => Known::Nothing,
            known => known,
        };
        let cameras = self.depth.cameras(views.paths(), sizes, known)?;
        let is_calibrated = !matches!(cameras, Cameras::Unknown);
        self.cloud.check(is_calibrated)?;
        self.check_places(output, is_calibrated)?;
        let Geometry { way, calibration, notes } = self.rectify.geometry(cameras, sizes)?;
        warnings.extend(notes);
        let names = views.paths().map(|path| path.display().to_string());
        let job = Job { names, left, right, stretch, config, way, map_back: self.map_back, strongest, calibration };
        Ok(Prepared { job, warnings })
    }

    /// Adds all files of a matched pair, the report last, with the `inputs` that the pair was made of, if they are known.
    pub fn add_files(
        &self,
        completed: &mut CompletedJob,
        inputs: Option<&Value>,
        output: &mut Output,
    ) -> hsad::Result<()> {
        completed.add_maps(output, &self.cloud)?;
        if let Some(pair) = &completed.rectified {
            rectification::add_files(pair, &names::RECTIFIED_FIRST, output)?;
        }
        if self.figures {
            completed.add_figures(output)?;
        }
        if self.matches {
            completed.add_matches(output)?;
        }
        let mut report = completed.report();
        if let Some(inputs) = inputs {
            report["inputs"] = inputs.clone();
        }
        products::add_report(output, report)
    }

    /// Checks that each file that is sure to be written may be.
    fn check_places(&self, output: &Output, is_calibrated: bool) -> hsad::Result<()> {
        let figures = names::FIGURES.into_iter().filter(|_| self.figures);
        let tables = self.matches.then_some(names::MATCHES);
        let mesh = self.cloud.mesh.then_some(names::MESH);
        products::maps(is_calibrated).chain(figures).chain(tables).chain(mesh).try_for_each(|name| output.check(name))
    }
}
