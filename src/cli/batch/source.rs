//! Where the pairs of a batch come from.

use std::{path::Path, sync::PoisonError};

use anyhow::{Result, bail};
use hsad::{
    image::Size,
    io::{
        load,
        recording::{LeftOut, RecordedCalibration, Recording, Shot},
    },
};

use super::{
    super::{output::is_stdout, recipe::Own, terminal},
    Batch,
    feed::Pairs,
    frame::Frame,
    given::{Given, Summary},
    list::{self, List},
    listing::Listing,
    pair::Pair,
    patterns, tree,
    video::{Video, is_video},
};

/// The pairs of a batch.
pub struct Source {
    pub pairs: Pairs,
    /// The number of pairs, if it is known.
    pub count: Option<usize>,
    /// What a pair may have of its own.
    pub own: Own,
    /// The calibration of a recording.
    pub recorded: Option<RecordedCalibration>,
    /// What the summary says of views that are in no pair, once all pairs were read; `None` if there are none.
    pub left_out: Box<dyn FnOnce() -> Option<String>>,
}

impl Source {
    /// Where the pairs of a run come from.
    ///
    /// # Errors
    /// What is wrong with the options, or with the list, folder, video or recording.
    pub fn of(batch: &Batch) -> Result<Self> {
        if let Some(source) = batch.source.as_deref().filter(|source| !is_stdout(source))
            && let Ok(false) = source.try_exists()
        {
            bail!("{}: no such file or folder", hsad::shown(source));
        }
        // Where the pictures of a recording lie beside it, they are what is matched.
        let is_recording = |source: &Path| Recording::is_one(source) && tree::folders_of_views(source).is_none();
        let is_recording = batch.source.as_deref().is_some_and(is_recording);
        if batch.topics.is_some() && !is_recording {
            bail!("--topics names topics of a recording (.mcap)");
        }
        if batch.no_camera_info && !is_recording {
            bail!("--no-camera-info is about a recording (.mcap)");
        }
        let given = match (&batch.source, &batch.left, &batch.right) {
            (None, Some(left), Some(right)) => Given::Found(patterns::pairs(left, right)?),
            (None, Some(both), None) => Given::Found(Listing::of(patterns::pictures_of_both(both)?)),
            (Some(source), ..) if is_recording => return Self::of_recording(source, batch),
            (Some(source), ..) if is_video(source) => return Self::of_video(source, batch),
            (Some(source), ..) if source.is_dir() => Given::Found(tree::pairs(source)?),
            (Some(source), ..) if list::is_list(source) => Given::Listed(List::read(source)?),
            (Some(source), ..) => bail!(
                "{}: neither a folder nor a list of pairs (.csv, .jsonl) nor a video (.y4m) nor a recording (.mcap); hsad match matches a pair",
                hsad::shown(source)
            ),
            _ => bail!("name a list or a folder, or --left and --right"),
        };
        let left_out = given.left_out();
        let Summary { count, has_calibrations, has_both_in_one } = given.check(&batch.output)?;
        if count == 0 {
            bail!("{}: no pairs", hsad::shown(batch.source.as_deref().unwrap_or(Path::new("the list"))));
        }
        if batch.halves.halves().is_some() && !has_both_in_one {
            bail!("every pair has a right view of its own: leave out --side-by-side and --top-bottom");
        }
        let own = if has_calibrations { Own::Calibration } else { Own::Nothing };
        let pairs = Box::new(given.into_pairs().map(|pair| Ok((pair?, None))));
        Ok(Self { pairs, count: Some(count), own, recorded: None, left_out: Box::new(|| left_out) })
    }

    fn of_video(path: &Path, batch: &Batch) -> Result<Self> {
        if batch.halves.halves().is_none() {
            bail!("{}: tell where both views lie in a frame (--side-by-side, --top-bottom)", hsad::shown(path));
        }
        let frames = Video::open(path)?;
        let pairs = frames.map(|frame| frame.map(|(pair, frame)| (pair, Some(Frame::Both(frame)))));
        let left_out = Box::new(|| None);
        Ok(Self { pairs: Box::new(pairs), count: None, own: Own::Nothing, recorded: None, left_out })
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
        let topics = views.map(|topic| topic.name.clone());
        let mut frames = recording.pairs(views);
        let left_out = frames.left_out();
        let calibration = match batch.no_camera_info || batch.recipe.has_calibration() {
            true => Ok(None),
            false => recording.calibration(views).map_err(anyhow::Error::from),
        };
        let mut first = None;
        let fits = |calibration: Option<RecordedCalibration>| -> Result<_> {
            if let Some(calibration) = &calibration {
                first = frames.next();
                let sizes = first.iter().flatten().find_map(|(_, shots)| sizes(shots));
                sizes.map_or(Ok(()), |sizes| calibration.check_sizes(sizes))?;
            }
            Ok(calibration)
        };
        let calibration = calibration.and_then(fits).unwrap_or_else(|error| {
            if !batch.run.quiet {
                terminal::warning(format_args!("the calibration of the recording is not used: {error:#}"));
            }
            None
        });
        let own = calibration.as_ref().map_or(Own::Nothing, |calibration| match calibration.is_rectified {
            true => Own::Geometry,
            false => Own::Calibration,
        });
        let pairs = first.into_iter().chain(frames).map(|read| {
            let (name, shots) = read?;
            let [left, right] = shots.each_ref().map(|shot| shot.path.clone());
            let pair = Pair { name, left, right: Some(right), calibration: None };
            Ok((pair, Some(Frame::Each(Box::new(shots)))))
        });
        Ok(Self {
            pairs: Box::new(pairs),
            count: None,
            own,
            recorded: calibration,
            left_out: Box::new(move || told(&left_out.lock().unwrap_or_else(PoisonError::into_inner), &topics)),
        })
    }
}

/// The sizes of two frames; `None` if they cannot be read.
fn sizes(shots: &[Shot; 2]) -> Option<[Size; 2]> {
    let size = |shot: &Shot| Some(load::decode(&shot.to_file().ok()?, &shot.path).ok()?.size());
    let [left, right] = shots.each_ref().map(size);
    Some([left?, right?])
}

/// Frames of two topics that are in no pair, for the summary; `None` if there are none.
fn told(left_out: &LeftOut, [left, right]: &[String; 2]) -> Option<String> {
    let count = |kind: &str, counts: [u64; 2]| {
        let text = format!("{kind}: {} of {left}, {} of {right}", counts[0], counts[1]);
        (counts != [0, 0]).then_some(text)
    };
    let LeftOut { alone, given_up, damaged, reason } = left_out;
    let given_up = count("given up, recorded more than 256 MiB ahead of the other topic", *given_up)
        .map(|text| format!("{text} (mcap sort IN.mcap -o OUT.mcap brings both in the order of their times)"));
    let damaged = count("frames whose time cannot be read", *damaged)
        .map(|text| format!("{text} ({})", reason.as_deref().unwrap_or_default()));
    let all: Vec<String> =
        count("frames without a partner", *alone).into_iter().chain(given_up).chain(damaged).collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_are_left_out_are_told_with_the_reason() {
        let topics = ["/left", "/right"].map(str::to_owned);
        assert_eq!(told(&LeftOut::default(), &topics), None);
        let damaged = LeftOut { damaged: [0, 1], reason: Some("cut off".into()), ..LeftOut::default() };
        let expected = "frames whose time cannot be read: 0 of /left, 1 of /right (cut off)";
        assert_eq!(told(&damaged, &topics).unwrap(), expected);
        let in_turn = LeftOut { alone: [9, 8], given_up: [7, 0], ..LeftOut::default() };
        let text = told(&in_turn, &topics).unwrap();
        let [alone, given_up] = text.lines().collect::<Vec<_>>()[..] else { panic!("{text}") };
        assert_eq!(alone, "frames without a partner: 9 of /left, 8 of /right");
        assert!(given_up.contains("7 of /left, 0 of /right (mcap sort"), "{given_up}");
    }
}
