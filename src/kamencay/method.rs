//! The sequence of steps, common to kernels and CPU twins.

use super::{
    KamencayConfig, KamencayParameters, Links, MAX_MESSAGE_BYTES, Segments, Strip,
    grid::{levels, strips},
    kernels::Winner,
    segment_disparity::conclude,
};
use crate::{
    dense::{Brightness, Dense, View},
    disparity::DisparityRange,
    error::{Error, Result},
    image::{Plane, Size, luma_of},
    io::Picture,
};

/// A matching problem. With the right view as the reference, both views are exchanged and mirrored, so that the left
/// one is always the reference.
pub(crate) struct Problem {
    /// Both views, from [`described`].
    pub(crate) left: Plane<u32>,
    pub(crate) right: Plane<u32>,
    pub(crate) range: DisparityRange,
    pub(crate) parameters: KamencayParameters,
}

/// The steps on pictures and volumes: kernels, or their CPU twins.
pub(crate) trait Solver {
    /// Filters the left view by mean shift.
    async fn modes(&mut self, problem: &Problem) -> Result<Plane<u32>>;

    /// Returns the winners of a strip's pixels, after belief propagation on `grids`, sizes with links, finest first.
    async fn winners(&mut self, problem: &Problem, strip: Strip, grids: &[(Size, Links)]) -> Result<Vec<Winner>>;
}

/// Packs red, green, blue and gradient of each pixel, after a change of brightness, into one `u32`, from the lowest
/// byte on. The gradient is the difference of luma of the two neighbours in the row, clamped to -127..127, plus 128.
pub fn described(picture: &Picture, brightness: Brightness) -> Plane<u32> {
    let picture = picture.map(|&[red, green, blue, _]| [red, green, blue].map(|level| brightness.apply(level)));
    let last = picture.width() - 1;
    Plane::from_fn(picture.size(), |x, y| {
        let grey = |x: u32| i32::from(luma_of(picture.get(x, y)));
        let gradient = (grey((x + 1).min(last)) - grey(x.saturating_sub(1))).clamp(-127, 127) + 128;
        let [red, green, blue] = picture.get(x, y);
        u32::from_le_bytes([red, green, blue, gradient as u8])
    })
}

/// The luma of a view from [`described`].
fn luma_plane(view: &Plane<u32>) -> Plane<u8> {
    view.map(|word| {
        let [red, green, blue, _] = word.to_le_bytes();
        luma_of([red, green, blue])
    })
}

fn mirrored<T: Copy>(plane: &Plane<T>) -> Plane<T> {
    let last = plane.width() - 1;
    Plane::from_fn(plane.size(), |x, y| plane.get(last - x, y))
}

/// Computes the disparity map of a pair.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`], [`Error::TooLarge`], and what the solver reports.
pub(crate) async fn solve(
    left: &Picture,
    right: &Picture,
    config: &KamencayConfig,
    message_bytes: u64,
    solver: &mut impl Solver,
) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    config.validate()?;
    let Size { width, height } = left.size();
    let range = config.searched(width)?;
    let strips = strips(Size::new(width, height), range.count, message_bytes.min(MAX_MESSAGE_BYTES))?;
    let parameters = config.parameters;
    let (left, right) = (described(left, Brightness::SAME), described(right, config.brightness));
    let problem = match config.reference {
        View::Left => Problem { left, right, range, parameters },
        View::Right => {
            // Mirroring also negates the gradients, in both views alike.
            Problem { left: mirrored(&right), right: mirrored(&left), range, parameters }
        }
    };
    let modes = solver.modes(&problem).await?;
    let segments = Segments::new(&modes, parameters.segmentation);
    let mut winners = Vec::with_capacity(modes.data().len());
    for (strip, decided) in strips {
        let links = Links::new(&problem.left, &segments, strip, parameters.links);
        let links = std::iter::successors(Some(links), |links| Some(links.reduced()));
        let grids: Vec<_> = levels(Size::new(width, strip.rows), parameters.levels).into_iter().zip(links).collect();
        let strip_winners = solver.winners(&problem, strip, &grids).await?;
        let first = ((decided.first_row - strip.first_row) * width) as usize;
        winners.extend_from_slice(&strip_winners[first..][..(decided.rows * width) as usize]);
    }
    let winners = Plane::new((width, height), winners)?;
    let views = [&problem.left, &problem.right].map(luma_plane);
    let dense = conclude(&winners, &segments, range, &parameters.conclusion, [&views[0], &views[1]]);
    Ok(match config.reference {
        View::Left => dense,
        View::Right => Dense { disparity: mirrored(&dense.disparity), confidence: mirrored(&dense.confidence) },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_described_by_its_colour_and_gradient() {
        let picture = Picture::new((3, 1), vec![[10, 20, 30, 7], [0, 0, 0, 0], [200, 200, 200, 0]]).unwrap();
        // Lumas 18, 0 and 200: gradients 0 - 18, 200 - 18 and 200 - 0, the last two beyond 127.
        let expected = [[10, 20, 30, 110], [0, 0, 0, 255], [200, 200, 200, 255]].map(u32::from_le_bytes);
        assert_eq!(described(&picture, Brightness::SAME).data(), expected);
        let brighter = described(&picture, Brightness { gain: 512, offset: 256 });
        assert_eq!(brighter.get(0, 0).to_le_bytes()[..3], [21, 41, 61]);
    }
}
