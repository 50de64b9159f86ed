//! `hsad batch`: many pairs on one device.

mod desk;
mod feed;
mod frame;
mod given;
mod inputs;
mod journal;
mod list;
mod listing;
mod load;
mod names;
mod pair;
mod patterns;
mod record;
mod results;
mod shard;
mod source;
mod storage;
mod tally;
mod tree;
mod video;
mod work;
mod workers;

use std::{
    fs,
    num::NonZero,
    path::{Path, PathBuf},
    thread,
};

use anyhow::{Result, anyhow};
use clap::Args;
use hsad::{internals::fnv1a, shown};

use super::{options::RunOptions, recipe::Recipe, report::parameters, view_files::HalvesOptions};
use desk::Desk;
use feed::{Feed, Grouping};
use journal::{Earlier, Journal};
use load::Load;
use results::Results;
use shard::Shard;
use source::Source;
use tally::Tally;
use work::Work;
use workers::side_by_side;

/// Most pairs that are worked on at once, unless it is told.
const MOST_JOBS: usize = 8;

/// Device memory that is kept for pairs of sizes and ranges that were matched, in bytes.
const KEPT: u64 = 1 << 30;

/// Match many pairs on one device
///
/// Each pair gets a folder of its own in the output folder, with the files of hsad match. A pair that cannot be matched is recorded and
/// passed over. report.jsonl has a line per pair, written when its files are in their place: --resume goes on after an interruption and
/// redoes nothing but what failed.
///
/// Several pairs are worked on at once, so that reading, the device and writing overlap; each takes the memory of a pair.
#[derive(Args)]
#[command(after_help = concat!("Examples:
  hsad batch pairs.csv -o out
  hsad batch KITTI/training -o out --calib calib.txt
  hsad batch --left 'cam0/*.png' --right 'cam1/*.png' -o out --resume
  hsad batch pairs.jsonl -o out --shard $SLURM_ARRAY_TASK_ID/64
  ffmpeg -i video.mp4 -f yuv4mpegpipe - | hsad batch - --side-by-side left-right -o out --temporal
  hsad batch ride.mcap --topics /cam0/image_raw /cam1/image_raw -o out

A list is CSV with the columns left, right, name and calib in any order (right is missing where left has both views), or JSON lines with
the same fields; paths are relative to the list.

Exit codes: 0 all pairs done, 1 some failed, 4 all files are written and some maps are not to be trusted or have no depth, 2 usage"))]
pub struct Batch {
    /// A list of pairs (.csv, .jsonl), or a folder of KITTI, Middlebury, ETH3D or EuRoC, or one with left and right, or with a folder per pair;
    /// or a video with both views in each frame, as ffmpeg -f yuv4mpegpipe writes it (.y4m, or - for standard input); or a recording of ROS (.mcap,
    /// or a folder of them, as ros2 bag record -s mcap writes)
    #[arg(required_unless_present = "left")]
    source: Option<PathBuf>,
    /// Left views: a path with one *, whose text names the pair; or pictures with both views, with --side-by-side or --top-bottom
    #[arg(long, value_name = "PATTERN", requires = "second_view", conflicts_with = "source")]
    left: Option<String>,
    /// Right views: a path with one *
    #[arg(long, value_name = "PATTERN", requires = "left", group = "second_view")]
    right: Option<String>,
    /// Topics of the left and of the right view in a recording [default: those whose names differ in left and right, cam0 and cam1, or
    /// infra1 and infra2]
    #[arg(long, num_args = 2, value_names = ["LEFT", "RIGHT"], conflicts_with = "left")]
    topics: Option<Vec<String>>,
    /// Leave out the calibration that a recording has (camera_info)
    #[arg(long, conflicts_with = "left")]
    no_camera_info: bool,
    /// Output folder, created if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Go on with the batch of this folder
    #[arg(long)]
    resume: bool,
    /// Work on every N-th pair from pair I on, I from 0 to N-1; the journal is report-I-of-N.jsonl then
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// The pairs are frames of a sequence, in order, from cameras that stand still against each other: one frame in N [default: 16] is
    /// matched by itself, and what it was found to be (rows, range, brightness) holds for those after it, unless they show otherwise.
    /// Frames of N are worked on one after the other, and belong to one shard
    #[arg(
        long,
        value_name = "N",
        num_args = 0..=1,
        default_missing_value = "16",
        value_parser = clap::value_parser!(u16).range(2..),
        conflicts_with_all = ["figures", "matches"]
    )]
    temporal: Option<u16>,
    /// Pairs that are worked on at once [default: one more than there are processors, 2 to 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    #[command(flatten)]
    halves: HalvesOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    recipe: Recipe,
}

/// Pairs that failed, or whose maps are doubtful.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Shortfall(String, i32);

impl Shortfall {
    /// The exit code of the run.
    pub fn exit_code(&self) -> i32 {
        self.1
    }
}

impl Batch {
    /// Matches all pairs.
    pub fn run(self) -> Result<()> {
        let (config, strongest) = self.recipe.config()?;
        let parameters = parameters(&config, strongest);
        let source = Source::of(&self)?;
        self.recipe.check_common(source.own)?;
        let grouping = Grouping { length: self.temporal.map_or(1, usize::from), shard: self.shard };
        let name = self.shard.map_or_else(|| "report.jsonl".into(), Shard::journal);
        let temporal = self.temporal.map(|length| format!(" temporal {length}")).unwrap_or_default();
        let recorded = source.recorded.as_ref().map(|recorded| fnv1a(format!("{:?}", recorded.loaded).into_bytes()));
        let recorded = recorded.map(|hash| format!(" camera_info {hash:016x}")).unwrap_or_default();
        let recipe = format!("{} {:?}{temporal}{recorded}", self.recipe.described()?, self.halves);
        fs::create_dir_all(&self.output).map_err(|source| hsad::Error::Io { path: self.output.clone(), source })?;
        let (journal, earlier) = Journal::open(&self.output, &name, &recipe, self.resume)?;
        let results = Results { folder: &self.output, resumes: self.resume, parameters };
        let tally = Tally::new(source.count.map(|count| grouping.count(count)), self.run.quiet);
        let desk = Desk::new(journal, tally);
        self.work_on(source, grouping, &earlier, &results, &desk)?;
        let (tally, result) = desk.close();
        if result.is_ok() || tally.all() > 0 {
            tally.finish(&self.output.join(name))?;
        }
        result?;
        match tally.shortfall() {
            None => Ok(()),
            Some((reason, code)) => Err(Shortfall(reason, code).into()),
        }
    }

    /// Works on the pairs of `source`, several groups at once, and brings their records to the `desk`. Ends with the first record that cannot
    /// be written, with a device that is lost, and with storage that takes no more files.
    fn work_on(
        &self,
        source: Source,
        grouping: Grouping,
        earlier: &Earlier,
        results: &Results<'_>,
        desk: &Desk,
    ) -> Result<()> {
        let feed = Feed::new(source.pairs, grouping, |pair, frame| {
            let finished = earlier.finished(pair, frame, results)?;
            finished.iter().for_each(|finished| desk.count_earlier(&pair.name, finished));
            Ok(finished.cloned())
        });
        if feed.has_work() {
            let cached = self.run.open()?.keeping(KEPT);
            let load = Load::begin(&cached.backend);
            let halves = self.halves.halves();
            let recorded = source.recorded.as_ref();
            let work = Work { backend: &cached.backend, recipe: &self.recipe, halves, recorded, results, earlier };
            side_by_side(source.count.unwrap_or(usize::MAX).min(self.jobs()), || {
                while let Some(group) = feed.group() {
                    if work.on_group(group, |record| desk.record(record.map_err(Into::into))).is_break() {
                        feed.stop();
                    }
                }
            });
            desk.note_load(load.elapsed(), &load.shares(&cached.backend));
            cached.save();
        }
        let is_empty = feed.is_empty();
        let left_out = (source.left_out)();
        match feed.into_error() {
            Some(error) => desk.end(error),
            None if is_empty => {
                let told = left_out.iter().fold("no pairs".to_owned(), |told, left_out| told + ": " + left_out);
                let source = self.source.as_deref().unwrap_or(Path::new("the list"));
                desk.end(anyhow!("{}: {told}", shown(source)));
            }
            None => {}
        }
        desk.note_left_out(left_out);
        Ok(())
    }

    /// Groups of pairs that are worked on at once: one where the system allows no threads and this one does all the work, for which others
    /// would wait in vain.
    fn jobs(&self) -> usize {
        if rayon::current_thread_index().is_some() {
            return 1;
        }
        // One is written, which waits for the disk, while the others keep the processors busy.
        let processors = || thread::available_parallelism().map_or(1, NonZero::get);
        self.jobs.map_or_else(|| (processors() + 1).min(MOST_JOBS), usize::from)
    }
}
