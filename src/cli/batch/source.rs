//! Where the pairs of a batch come from.

use std::{
    path::Path,
    sync::{Arc, Mutex, PoisonError},
};

use anyhow::{Result, bail};
use hsad::io::recording::{LeftOut, RecordedCalibration, Recording};

use super::{
    super::terminal,
    Batch,
    feed::Pairs,
    frame::Frame,
    list,
    pair::{self, Pair},
    patterns, tree,
    video::{Video, is_video},
};

/// The pairs of a batch.
pub struct Source {
    pub pairs: Pairs,
    /// The number of pairs, if it is known.
    pub count: Option<usize>,
    /// Whether a pair may have a calibration of its own.
    pub has_calibrations: bool,
    /// What a recording tells besides its pairs.
    pub recorded: Option<Recorded>,
}

/// What a recording tells besides its pairs.
pub struct Recorded {
    topics: [String; 2],
    pub calibration: Option<RecordedCalibration>,
    left_out: Arc<Mutex<LeftOut>>,
}

impl Source {
    /// Where the pairs of a run come from.
    ///
    /// # Errors
    /// What is wrong with the options, or with the list, folder, video or recording.
    pub fn of(batch: &Batch) -> Result<Self> {
        let is_recording = batch.source.as_deref().is_some_and(Recording::is_one);
        if batch.topics.is_some() && !is_recording {
            bail!("--topics names topics of a recording (.mcap)");
        }
        let pairs = match (&batch.source, &batch.left, &batch.right) {
            (None, Some(left), Some(right)) => patterns::pairs(left, right)?,
            (None, Some(both), None) => patterns::pictures_of_both(both)?,
            (Some(source), ..) if is_recording => return Self::of_recording(source, batch),
            (Some(source), ..) if is_video(source) => return Self::of_video(source, batch),
            (Some(source), ..) if source.is_dir() => tree::pairs(source)?,
            (Some(source), ..) if list::is_list(source) => list::read(source)?,
            (Some(source), ..) => bail!(
                "{}: neither a folder nor a list of pairs (.csv, .jsonl) nor a video (.y4m) nor a recording (.mcap); hsad match matches a pair",
                hsad::shown(source)
            ),
            _ => bail!("name a list or a folder, or --left and --right"),
        };
        if pairs.is_empty() {
            bail!("{}: no pairs", hsad::shown(batch.source.as_deref().unwrap_or(Path::new("the list"))));
        }
        pair::check_names(&pairs)?;
        let count = Some(pairs.len());
        let has_calibrations = pairs.iter().any(|pair| pair.calibration.is_some());
        let pairs = Box::new(pairs.into_iter().map(|pair| Ok((pair, None))));
        Ok(Self { pairs, count, has_calibrations, recorded: None })
    }

    fn of_video(path: &Path, batch: &Batch) -> Result<Self> {
        if batch.halves.halves().is_none() {
            bail!("{}: tell where both views lie in a frame (--side-by-side, --top-bottom)", hsad::shown(path));
        }
        let frames = Video::open(path)?;
        let pairs = frames.map(|frame| frame.map(|(pair, frame)| (pair, Some(Frame::Both(frame)))));
        Ok(Self { pairs: Box::new(pairs), count: None, has_calibrations: false, recorded: None })
    }

    fn of_recording(path: &Path, batch: &Batch) -> Result<Self> {
        if batch.halves.halves().is_some() {
            bail!("{}: a recording has a topic per view: leave out --side-by-side and --top-bottom", hsad::shown(path));
        }
        let recording = Recording::open(path)?;
        let named = batch.topics.as_deref().and_then(|names| Some([names.first()?.as_str(), names.get(1)?.as_str()]));
        let views = recording.both_views(named).map_err(|error| match named {
            Some(_) => error.into(),
            None => anyhow::anyhow!("{error}: name two with --topics LEFT RIGHT"),
        })?;
        let calibration = recording.calibration(views).unwrap_or_else(|error| {
            if !batch.run.quiet {
                terminal::warning(format_args!("the calibration of the recording is not used: {error}"));
            }
            None
        });
        let has_calibrations = calibration.is_some();
        let frames = recording.pairs(views)?;
        let recorded =
            Recorded { topics: views.map(|topic| topic.name.clone()), calibration, left_out: frames.left_out() };
        let pairs = frames.map(|read| {
            let (stamp, shots) = read?;
            let [left, right] = shots.each_ref().map(|shot| shot.path.clone());
            let pair = Pair { name: stamp.to_string(), left, right: Some(right), calibration: None };
            Ok((pair, Some(Frame::Each(Box::new(shots)))))
        });
        Ok(Self { pairs: Box::new(pairs), count: None, has_calibrations, recorded: Some(recorded) })
    }
}

impl Recorded {
    /// Frames that are in no pair, for the summary; `None` if there are none.
    pub fn left_out(&self) -> Option<String> {
        let LeftOut { alone, damaged, reason } = self.left_out.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let count = |kind: &str, counts: [u64; 2]| {
            let [left, right] = &self.topics;
            let text = format!("{kind}: {} of {left}, {} of {right}", counts[0], counts[1]);
            (counts != [0, 0]).then_some(text)
        };
        let damaged = count("frames whose time cannot be read", damaged)
            .map(|text| format!("{text} ({})", reason.unwrap_or_default()));
        let all: Vec<String> = count("frames without a partner", alone).into_iter().chain(damaged).collect();
        (!all.is_empty()).then(|| all.join("\n"))
    }
}
