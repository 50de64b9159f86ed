//! Frames of a video, each with both views: YUV4MPEG2, which `ffmpeg -f yuv4mpegpipe` writes to a file or a pipe.

use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, anyhow, bail};
use hsad::io::MAX_PIXELS;

use super::{super::output::is_stdout, pair::Pair};

/// Longest line of parameters, in bytes.
const LONGEST_LINE: usize = 1024;
/// What each frame begins with.
const BEGINNING: &[u8] = b"FRAME";
/// Height from which the colours of a video are those of HDTV (BT.709), and not of earlier television (BT.601): what encoders assume.
const HDTV: u32 = 720;

/// A video that is read from its beginning.
pub struct Video {
    from: Box<dyn Read + Send>,
    path: PathBuf,
    head: Head,
    number: u32,
    /// The first bytes of the next frame, once the frame before it was read.
    ahead: Option<Vec<u8>>,
}

/// The parameters of all frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Head {
    width: u32,
    height: u32,
    /// Binary logarithms of the pixels that share a chroma sample, beside and above each other; `None`: grey.
    chroma: Option<[u32; 2]>,
    /// Whether levels go from 0 to 255, and not from 16 to 235.
    is_full: bool,
}

/// A frame as it was read.
pub struct Frame {
    head: Head,
    planes: Vec<u8>,
}

/// Whether a source is a video: standard input, or a file by its extension.
pub fn is_video(path: &Path) -> bool {
    is_stdout(path) || path.extension().is_some_and(|found| found.eq_ignore_ascii_case("y4m"))
}

impl Video {
    /// Opens a video; `-` is standard input.
    ///
    /// # Errors
    /// A file that cannot be read, and one that is no such video.
    pub fn open(path: &Path) -> Result<Self> {
        if is_stdout(path) {
            return Self::new(Box::new(BufReader::new(io::stdin())), path);
        }
        let file = File::open(path).map_err(|source| hsad::Error::Io { path: path.into(), source })?;
        Self::new(Box::new(BufReader::new(file)), path)
    }

    fn new(mut from: Box<dyn Read + Send>, path: &Path) -> Result<Self> {
        let told = |what: &str| anyhow!("{}: {what}", hsad::shown(path));
        let line = line(&mut from).map_err(|error| told(&error.to_string()))?;
        let words = line.as_deref().and_then(|line| line.strip_prefix("YUV4MPEG2"));
        let Some(words) = words else {
            return Err(told("no video of uncompressed frames: ffmpeg -i VIDEO -f yuv4mpegpipe - | hsad batch - ..."));
        };
        let head = Head::of(words).map_err(|error| told(&format!("{error:#}")))?;
        Ok(Self { from, path: path.into(), head, number: 0, ahead: None })
    }

    /// The first bytes of the next frame, fewer than it has where the video is cut off, none at its end.
    fn beginning(&mut self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.from.by_ref().take(BEGINNING.len() as u64).read_to_end(&mut bytes)?;
        if !BEGINNING.starts_with(&bytes) {
            let Head { width, height, .. } = self.head;
            bail!("no frame begins where one should: frames may be of another size than {width}x{height} pixels");
        }
        Ok(bytes)
    }

    /// The next frame, as a pair whose name is its number from 1 on. A frame counts once the next one, or the end, was found behind it: one
    /// that the header gives another size is sheared.
    fn frame(&mut self) -> Result<Option<(Pair, Frame)>> {
        let beginning = self.ahead.take().map_or_else(|| self.beginning(), Ok)?;
        if beginning.is_empty() {
            return Ok(None);
        }
        let parameters = line(&mut self.from)?.context("the video is cut off")?;
        if !parameters.is_empty() && !parameters.starts_with(' ') {
            bail!("no frame begins where one should");
        }
        let mut planes = vec![0; self.head.bytes()];
        self.from.read_exact(&mut planes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => anyhow!("the video is cut off"),
            _ => error.into(),
        })?;
        self.ahead = Some(self.beginning()?);
        self.number += 1;
        let name = format!("{:06}", self.number);
        let left = PathBuf::from(format!("{}#{name}", self.path.display()));
        let pair = Pair { name, left, right: None, calibration: None };
        Ok(Some((pair, Frame { head: self.head, planes })))
    }
}

impl Iterator for Video {
    type Item = Result<(Pair, Frame)>;

    fn next(&mut self) -> Option<Self::Item> {
        let frame = self
            .frame()
            .map_err(|error| anyhow!("{}: after frame {}: {error:#}", hsad::shown(&self.path), self.number));
        frame.transpose()
    }
}

impl Head {
    /// The parameters of a video from the words of its first line.
    fn of(words: &str) -> Result<Self> {
        let (mut width, mut height, mut chroma, mut is_full) = (0, 0, Some([1, 1]), false);
        for word in words.split(' ').filter(|word| !word.is_empty()) {
            let (letter, value) = word.split_at(word.chars().next().map_or(0, char::len_utf8));
            match letter {
                "W" => width = value.parse()?,
                "H" => height = value.parse()?,
                "C" => {
                    chroma = match value {
                        "420" | "420jpeg" | "420mpeg2" | "420paldv" => Some([1, 1]),
                        "422" => Some([1, 0]),
                        "444" => Some([0, 0]),
                        "mono" => None,
                        _ => bail!("samples of the kind {value} are not read: ffmpeg -pix_fmt yuv420p"),
                    }
                }
                "I" if !["p", "?"].contains(&value) => {
                    bail!("the frames are interlaced, and half of their rows of another time: ffmpeg -vf yadif")
                }
                "X" if value == "COLORRANGE=FULL" => is_full = true,
                _ => {}
            }
        }
        if width == 0 || height == 0 || u64::from(width) * u64::from(height) > MAX_PIXELS {
            bail!("frames of {width}x{height} pixels: 1 to {MAX_PIXELS} are read");
        }
        Ok(Self { width, height, chroma, is_full })
    }

    /// Width and height of the chroma planes.
    fn chroma_size(&self, [beside, above]: [u32; 2]) -> [usize; 2] {
        [self.width.div_ceil(1 << beside) as usize, self.height.div_ceil(1 << above) as usize]
    }

    /// Bytes of a frame.
    fn bytes(&self) -> usize {
        let luma = self.width as usize * self.height as usize;
        luma + self.chroma.map_or(0, |shifts| 2 * self.chroma_size(shifts).iter().product::<usize>())
    }
}

impl Frame {
    /// The samples, as they were read.
    pub fn samples(&self) -> &[u8] {
        &self.planes
    }

    /// A frame of as many bytes.
    #[cfg(test)]
    pub fn of_bytes(count: usize) -> Self {
        Self { head: Head { width: 1, height: 1, chroma: None, is_full: true }, planes: vec![0; count] }
    }

    /// The frame as a PPM, or a PGM if it is grey.
    pub fn to_pnm(&self) -> Vec<u8> {
        let Head { width, height, chroma, is_full } = self.head;
        let (luma, rest) = self.planes.split_at(width as usize * height as usize);
        let [black, white, reach] = if is_full { [0.0, 255.0, 255.0] } else { [16.0, 235.0, 224.0] };
        let level = |sample: u8| 255.0 * (f32::from(sample) - black) / (white - black);
        let Some(shifts) = chroma else {
            let grey = luma.iter().map(|&sample| level(sample).round() as u8);
            return format!("P5 {width} {height} 255\n").into_bytes().into_iter().chain(grey).collect();
        };
        // The parts of red and blue in luma.
        let [red, blue] = if height < HDTV { [0.299, 0.114] } else { [0.2126, 0.0722] };
        let green = 1.0 - red - blue;
        let [columns, rows] = self.head.chroma_size(shifts);
        let (blue_plane, red_plane) = rest.split_at(columns * rows);
        let difference = |plane: &[u8], place: usize| 255.0 * (f32::from(plane[place]) - 128.0) / reach;
        let mut pnm = format!("P6 {width} {height} 255\n").into_bytes();
        pnm.reserve(3 * luma.len());
        for (y, row) in luma.chunks(width as usize).enumerate() {
            for (x, &sample) in row.iter().enumerate() {
                let place = (y >> shifts[1]) * columns + (x >> shifts[0]);
                let (of_blue, of_red) = (difference(blue_plane, place), difference(red_plane, place));
                let level = level(sample);
                let [r, b] = [level + 2.0 * (1.0 - red) * of_red, level + 2.0 * (1.0 - blue) * of_blue];
                let g = (level - red * r - blue * b) / green;
                pnm.extend([r, g, b].map(|level| level.round() as u8));
            }
        }
        pnm
    }
}

/// A line without its end; `None` at the end of the file.
fn line(from: &mut impl Read) -> Result<Option<String>> {
    let mut bytes = Vec::new();
    let mut byte = [0];
    loop {
        if from.read(&mut byte)? == 0 {
            if bytes.is_empty() {
                return Ok(None);
            }
            bail!("the video is cut off");
        }
        match byte[0] {
            b'\n' => return Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
            _ if bytes.len() == LONGEST_LINE => bail!("a line of parameters has no end"),
            byte => bytes.push(byte),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn video(bytes: &[u8]) -> Result<Video> {
        Video::new(Box::new(io::Cursor::new(bytes.to_vec())), Path::new("v.y4m"))
    }

    #[test]
    fn frames_become_pictures() {
        // Grey of studio levels, then red of full range in BT.601: Y 76, U 85, V 255.
        let frames: Vec<_> = video(b"YUV4MPEG2 W2 H1 F30:1 Ip Cmono\nFRAME\n\x10\xebFRAME x\n\x00\x7e")
            .unwrap()
            .map(Result::unwrap)
            .collect();
        let names: Vec<_> =
            frames.iter().map(|(pair, _)| (pair.name.as_str(), pair.left.display().to_string())).collect();
        let expected = ["v.y4m#000001", "v.y4m#000002"].map(str::to_owned);
        assert_eq!(names, ["000001", "000002"].into_iter().zip(expected).collect::<Vec<_>>());
        assert_eq!(frames[0].1.to_pnm(), b"P5 2 1 255\n\x00\xff");
        assert_eq!(frames[1].1.to_pnm(), b"P5 2 1 255\n\x00\x80", "what is darker than black is black");
        let red = b"YUV4MPEG2 W3 H1 C420jpeg XCOLORRANGE=FULL\nFRAME\n\x4c\x4c\xff\x55\x80\xff\x80";
        let (_, frame) = video(red).unwrap().next().unwrap().unwrap();
        let pnm = frame.to_pnm();
        let (head, pixels) = pnm.split_at(11);
        assert_eq!(head, b"P6 3 1 255\n");
        let is_near = |(found, expected): (&u8, &u8)| found.abs_diff(*expected) <= 1;
        assert!(pixels.iter().zip(&[254, 0, 0, 254, 0, 0, 255, 255, 255]).all(is_near), "{pixels:?}");
    }

    #[test]
    fn what_is_no_video_is_told() {
        for (bytes, told) in [
            (&b"RIFF"[..], "cut off"),
            (b"RIFF\n", "ffmpeg"),
            (b"YUV4MPEG2 W2 H1 C420p10\n", "yuv420p"),
            (b"YUV4MPEG2 W2 H1 It\n", "interlaced"),
            (b"YUV4MPEG2 W2\n", "2x0 pixels"),
            (b"YUV4MPEG2 W-2\n", "v.y4m"),
            (&[b'Y'; 4000], "no end"),
        ] {
            let error = video(bytes).err().expect(told).to_string();
            assert!(error.contains(told), "{told}: {error}");
        }
        for (bytes, told) in [
            (&b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nab"[..], None),
            (b"YUV4MPEG2 W2 H1 Cmono\nFRAME\naFRAME\nab", Some("after frame 0: no frame begins")),
            (b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nabc", Some("another size than 2x1 pixels")),
            (b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nabFRA", Some("after frame 1: the video is cut off")),
            (b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nabFRAMES\nab", Some("after frame 1: no frame begins")),
            (b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nabFRAME\na", Some("after frame 1: the video is cut off")),
        ] {
            let errors: Vec<String> =
                video(bytes).unwrap().take(3).filter_map(|frame| Some(frame.err()?.to_string())).collect();
            assert_eq!(errors.is_empty(), told.is_none(), "{errors:?}");
            assert!(told.is_none_or(|told| errors[0].contains(told)), "{errors:?}");
        }
    }
}
