//! `hsad features`: the interest points of one picture.

use std::{io::Write, path::PathBuf};

use clap::Args;
use hsad::{
    features::{DESCRIPTOR_LENGTH, Detected, Feature, FeatureConfig},
    gpu::block_on,
    image::reduced,
    io::{figure, load, png},
    pipeline::reduction,
    seeding::enlarged_feature,
};

use super::{
    options::{FeatureOptions, RunOptions},
    output::Output,
    terminal::{self, Progress},
};

/// Find the interest points of one picture
///
/// Prints one CSV line per point: column and row of the centre (pixel centres are whole numbers),
/// scale in pixels, orientation in radians, response, and 1 for a dark blob on light ground or 0 for
/// a light blob on dark ground.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad features photo.jpg > features.csv
  hsad features photo.jpg -o out            features.csv and keypoints.png
  hsad features photo.jpg --oriented --descriptors --threshold 0.001")]
pub struct Features {
    /// Picture file: PNG, JPEG, PNM, PFM, BMP, TIFF or WebP
    image: PathBuf,
    /// Write features.csv and keypoints.png to this folder instead of printing the table
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Detect points at the picture's full size. By default a picture of more than 2 megapixels is
    /// first reduced by a whole factor, as `hsad match` does
    #[arg(long)]
    full_size: bool,
    /// Add the 64 descriptor values of each point as columns d0 to d63
    #[arg(long)]
    descriptors: bool,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    features: FeatureOptions,
}

impl Features {
    /// Detects the interest points and prints or writes them.
    pub fn run(self) -> anyhow::Result<()> {
        let config = self.features.over(FeatureConfig::default())?;
        config.validate()?;
        let mut output = self.output.as_deref().map(Output::open).transpose()?;
        let picture = load::load(&self.image)?;
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
            output.add("features.csv", |out| out.write_all(csv.as_bytes()))?;
            output.add("keypoints.png", |out| png::write_rgb8(out, &figure))?;
            output.finish()?;
        }
        drop(progress);

        let size = if factor == 1 { String::new() } else { format!(" at 1/{factor} of its size") };
        let strongest = if features.len() < found { format!(", the strongest of {found},") } else { String::new() };
        let found = format!("{} interest points{strongest}{size}, found by {}", features.len(), cached.backend.name());
        match output {
            Some(_) if self.run.quiet => {}
            Some(output) => terminal::print(&format!("{found}; see {}\n", output.folder().display()))?,
            None => {
                terminal::print(&csv)?;
                if !self.run.quiet {
                    // The note goes to stderr: on stdout it would be a line of the table.
                    terminal::note(&found);
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
