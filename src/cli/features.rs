//! `hsad features`: the interest points of one picture, or the matches of those of two.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use clap::Args;
use hsad::{
    Backend,
    features::{DESCRIPTOR_LENGTH, Detected, Feature, FeatureConfig},
    gpu::block_on,
    image::reduced,
    io::{
        Picture, figure,
        load::{self, LoadedPair, Unseen},
        png,
    },
    matching::MatchConfig,
    pipeline::reduction,
    report,
    seeding::{RawMatches, SeedingConfig, enlarged_feature},
};
use serde_json::{Value, json};

use super::{
    matches::MatchTable,
    names::{MATCHED_POINTS, POINTS, REPORT},
    options::{FeatureOptions, RunOptions, with_default},
    output::Output,
    products,
    terminal::{self, Progress},
    view_files::HalvesOptions,
};

/// Find the interest points of one picture, or match those of two
///
/// Prints one CSV line per point: column and row of the centre (pixel centres are whole numbers),
/// scale in pixels, orientation in radians, response, and 1 for a dark blob on light ground or 0 for
/// a light blob on dark ground.
///
/// With a second picture prints one line per match instead, found in any row: position, scale and
/// orientation in both pictures, distance of the descriptors, its ratio to that of the best rival,
/// confidence (1 less the ratio), and 1 where the match agrees with the rows along which most matches
/// correspond, or 0.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad features photo.jpg > features.csv
  hsad features photo.jpg -o out            features.csv, keypoints.png and report.json
  hsad features photo.jpg --oriented --descriptors --threshold 0.001
  hsad features left.jpg right.jpg > matches.csv
  hsad features photo.mpo --both-views > matches.csv
  hsad features left.jpg right.jpg -o out   matches.csv, matches.png and report.json")]
pub struct Features {
    /// Picture file: PNG, JPEG, PNM, PFM, BMP, TIFF or WebP
    image: PathBuf,
    /// Second picture, whose interest points are matched to those of the first
    #[arg(group = "second_view")]
    second: Option<PathBuf>,
    #[command(flatten)]
    halves: HalvesOptions,
    /// IMAGE has both views, and tells where: MPO of 3D cameras, JPS. Their interest points are matched
    #[arg(long, group = "second_view")]
    both_views: bool,
    /// Write features.csv and keypoints.png, or matches.csv and matches.png, and report.json to this folder instead of printing the table
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Detect points at the picture's full size. By default a picture of more than 2 megapixels is
    /// first reduced by a whole factor, as `hsad match` does
    #[arg(long)]
    full_size: bool,
    /// Add the 64 descriptor values of each point as columns d0 to d63
    #[arg(long, conflicts_with = "second_view")]
    descriptors: bool,
    #[arg(long, value_name = "R", requires = "second_view", help = with_default("Ratio test: largest ratio of the distances of the \
        best and the second best descriptor, above 0, at most 1", MatchConfig::default().ratio))]
    ratio: Option<f32>,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    features: FeatureOptions,
}

impl Features {
    /// Detects the interest points, matches those of two pictures, and prints or writes the table.
    pub fn run(self) -> anyhow::Result<()> {
        match &self.second {
            None if !self.both_views && self.halves.halves().is_none() => self.run_for_one(),
            second => self.run_for_two([&self.image, second.as_ref().unwrap_or(&self.image)]),
        }
    }

    fn run_for_one(&self) -> anyhow::Result<()> {
        let config = self.features.over(FeatureConfig::default())?;
        config.validate()?;
        let mut output = self.open_set(&[&self.image], &POINTS)?;
        let picture = self.load(&self.image)?;
        let cached = self.run.open()?;
        let progress = Progress::new(self.run.quiet);
        progress.begin("finding interest points");
        let luma = picture.luma();
        let factor = if self.full_size { 1 } else { reduction(luma.size()) };
        let Detected { features, found } = block_on(cached.backend.features(&reduced(&luma, factor), &config))?;
        cached.save();
        let features: Vec<_> = features.into_iter().map(|point| enlarged_feature(point, factor)).collect();

        let csv = csv(&features, self.descriptors);
        if let Some(output) = &mut output {
            progress.begin("writing");
            let figure = figure::keypoints(&picture, &features);
            let [table, drawn] = POINTS;
            output.add(table, |out| out.write_all(csv.as_bytes()))?;
            output.add(drawn, |out| png::write_rgb8(out, &figure))?;
            let figures = json!({ "points": features.len(), "found": found, "reduction": factor });
            self.finish(output, &[&self.image], &cached.backend, &figures)?;
        }
        drop(progress);

        let size = if factor == 1 { String::new() } else { format!(" at 1/{factor} of its size") };
        let strongest = if features.len() < found { format!(", the strongest of {found},") } else { String::new() };
        let found = format!("{} interest points{strongest}{size}, found by {}", features.len(), cached.backend.name());
        self.tell(output.as_ref(), &csv, &found)
    }

    fn run_for_two(&self, images: [&Path; 2]) -> anyhow::Result<()> {
        let config = self.features.over(FeatureConfig::default())?;
        config.validate()?;
        let mut seeding = SeedingConfig::default();
        seeding.matching.ratio = self.ratio.unwrap_or(seeding.matching.ratio);
        seeding.matching.validate()?;
        let mut output = self.open_set(&images, &MATCHED_POINTS)?;
        let [left, right] = self.views(images)?;
        let cached = self.run.open()?;
        let progress = Progress::new(self.run.quiet);
        progress.begin("finding interest points");
        let factor = if self.full_size { 1 } else { reduction(left.size()).max(reduction(right.size())) };
        let lumas = [&left, &right].map(|picture| reduced(&picture.luma(), factor));
        let detect = |luma| block_on(cached.backend.features(luma, &config)).map(|detected| detected.features);
        let features = [detect(&lumas[0])?, detect(&lumas[1])?];
        cached.save();
        progress.begin("matching interest points");
        let RawMatches { matches, rectification, .. } =
            RawMatches::new((&features[0], &features[1]), lumas[0].size(), &seeding)?;
        let features: [Vec<_>; 2] =
            features.map(|view| view.into_iter().map(|point| enlarged_feature(point, factor)).collect());
        let table = MatchTable {
            features: features.each_ref().map(Vec::as_slice),
            matches: &matches,
            rows: rectification.enlarged(factor).rows,
            max_dy: f64::from(seeding.max_dy) * f64::from(factor),
        };

        let csv = table.csv();
        if let Some(output) = &mut output {
            progress.begin("writing");
            let figure = figure::matches(&left, &right, &table.positions());
            let [table_file, drawn] = MATCHED_POINTS;
            output.add(table_file, |out| out.write_all(csv.as_bytes()))?;
            output.add(drawn, |out| png::write_rgb8(out, &figure))?;
            let points = features.each_ref().map(Vec::len);
            let figures = json!({ "points": points, "matches": matches.len(), "agreeing": table.agreeing(), "reduction": factor });
            self.finish(output, &images, &cached.backend, &figures)?;
        }
        drop(progress);
        let [of_left, of_right] = features.each_ref().map(Vec::len);
        let found = format!(
            "{} matches, {} of them in corresponding rows, of {of_left} and {of_right} interest points, found by {}",
            matches.len(),
            table.agreeing(),
            cached.backend.name()
        );
        self.tell(output.as_ref(), &csv, &found)
    }

    /// A picture, with a warning if its file is odd.
    fn load(&self, path: &Path) -> hsad::Result<Picture> {
        let (picture, doubt) = load::load_with_doubt(path)?;
        doubt.filter(|_| !self.run.quiet).iter().for_each(terminal::warning);
        Ok(picture)
    }

    /// Both pictures.
    fn views(&self, images: [&Path; 2]) -> hsad::Result<[Picture; 2]> {
        if self.second.is_some() {
            return Ok([self.load(images[0])?, self.load(images[1])?]);
        }
        let LoadedPair { left, right, warnings, .. } =
            load::load_both(images[0], self.halves.halves(), &Unseen::default())?;
        if !self.run.quiet {
            warnings.iter().for_each(terminal::warning);
        }
        Ok([left, right])
    }

    /// The output folder, if there is one; `names`: the files that will be written.
    fn open_set(&self, pictures: &[&Path], names: &[&str]) -> hsad::Result<Option<Output>> {
        let Some(folder) = &self.output else { return Ok(None) };
        let output = Output::open_set(folder)?.sparing(pictures.iter().copied());
        names.iter().chain(&[REPORT]).try_for_each(|name| output.check(name))?;
        Ok(Some(output))
    }

    /// Adds the report, and moves all files to their places.
    fn finish(&self, output: &mut Output, pictures: &[&Path], backend: &Backend, figures: &Value) -> hsad::Result<()> {
        let pictures: Vec<_> = pictures.iter().map(|path| path.display().to_string()).collect();
        let report = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "pictures": pictures,
            "device": report::device(backend),
            "features": figures,
        });
        products::add_report(output, report)?;
        output.finish_run(0)
    }

    /// Prints the table, or where its file is, and what was found.
    fn tell(&self, output: Option<&Output>, csv: &str, found: &str) -> anyhow::Result<()> {
        match output {
            Some(_) if self.run.quiet => {}
            Some(output) => terminal::print(&format!("{found}; see {}\n", hsad::shown(output.folder())))?,
            None => {
                terminal::print(csv)?;
                if !self.run.quiet {
                    // The note goes to stderr: on stdout it would be a line of the table.
                    terminal::note(found);
                }
            }
        }
        Ok(())
    }
}

fn csv(features: &[Feature], descriptors: bool) -> String {
    let mut text = String::from("x,y,scale,orientation,response,dark");
    let length = if descriptors { DESCRIPTOR_LENGTH } else { 0 };
    (0..length).for_each(|i| text += &format!(",d{i}"));
    text.push('\n');
    for Feature { x, y, scale, orientation, response, dark, descriptor } in features {
        text += &format!("{x},{y},{scale},{orientation},{response},{}", u8::from(*dark));
        descriptor[..length].iter().for_each(|value| text += &format!(",{value}"));
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_by_hand() {
        let feature = Feature {
            x: 1.5,
            y: 2.0,
            scale: 1.25,
            response: 0.001,
            dark: true,
            orientation: 0.0,
            descriptor: [0.5; 64],
        };
        assert_eq!(
            csv(std::slice::from_ref(&feature), false),
            "x,y,scale,orientation,response,dark\n1.5,2,1.25,0,0.001,1\n"
        );
        let long = csv(&[feature], true);
        let counts: Vec<usize> = long.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(counts, [70, 70]);
        assert!(long.lines().next().unwrap().ends_with(",d62,d63"));
    }
}
