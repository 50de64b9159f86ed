//! The determinant of the Hessian by box filters (Bay et al., 'Speeded-Up Robust Features', CVIU
//! 110, 2008, sections 3.2 and 3.3), exact in integers.

use rayon::prelude::*;

use crate::{cpu::features::integral::IntegralImage, image::Plane};

/// Intervals per octave.
pub const INTERVALS: usize = 4;

/// Sides of the filters, in pixels, one octave per row.
pub const FILTER_SIZES: [[u32; INTERVALS]; 5] =
    [[9, 15, 21, 27], [15, 27, 39, 51], [27, 51, 75, 99], [51, 99, 147, 195], [99, 195, 291, 387]];

/// The value here of a determinant of 1 on OpenSURF's scale (grey values 0 to 1): grey values are 0 to 255 in steps of
/// 1/256, and a determinant is a product of two such values.
pub const RESPONSE_SCALE: f64 = (255.0 * 256.0) * (255.0 * 256.0);

/// The responses of an octave's four filters on its grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Octave {
    /// Index of the octave, from 0.
    pub index: u32,
    /// Pixels between grid points: point `(i, j)` is pixel `(i * spacing, j * spacing)`.
    pub spacing: u32,
    /// Responses, one plane per interval.
    pub layers: [Plane<Response>; INTERVALS],
}

/// A determinant and the sign of the trace in one word; 0 where the filter does not fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Response(pub i32);

impl Response {
    fn new(determinant: i32, dark: bool) -> Self {
        Self(determinant << 1 | i32::from(dark))
    }

    /// The determinant, in units of 1 / [`RESPONSE_SCALE`].
    pub fn determinant(self) -> i32 {
        self.0 >> 1
    }

    /// Whether the trace is positive: dark in the middle, light around.
    pub fn dark(self) -> bool {
        self.0 & 1 == 1
    }
}

impl Octave {
    /// Evaluates octave `index` on a grid of `step << index` pixels.
    pub fn new(integral: &IntegralImage, index: u32, step: u32) -> Self {
        let spacing = step << index;
        let layers = FILTER_SIZES[index as usize].map(|size| layer(integral, size, spacing));
        Self { index, spacing, layers }
    }

    /// Sides of the filters, in pixels.
    pub fn sizes(&self) -> [u32; INTERVALS] {
        FILTER_SIZES[self.index as usize]
    }
}

/// Whether a filter of side `size` around pixel `(x, y)` lies in a picture of `width x height`.
pub fn fits(width: u32, height: u32, x: u32, y: u32, size: u32) -> bool {
    let border = size / 2;
    x >= border && y >= border && x + border < width && y + border < height
}

fn layer(integral: &IntegralImage, size: u32, spacing: u32) -> Plane<Response> {
    let (width, height) = (integral.width(), integral.height());
    let (columns, rows) = (width.div_ceil(spacing), height.div_ceil(spacing));
    let filter = Filter::new(size);
    let mut plane = Plane::filled((columns, rows), Response::default());
    plane.data_mut().par_chunks_mut(columns as usize).enumerate().for_each(|(j, row)| {
        let y = j as u32 * spacing;
        for (i, word) in row.iter_mut().enumerate() {
            let x = i as u32 * spacing;
            if fits(width, height, x, y, size) {
                *word = filter.response(integral, x, y);
            }
        }
    });
    plane
}

/// The three box filters of one size, with their normalisation.
struct Filter {
    size: u32,
    /// Factor from a sum over the filter to 1/256 grey level, normalised by area.
    scale: f32,
    /// Factor of the mixed derivative, which includes the balancing weight 0.9 (Bay et al., eq. 3).
    mixed_scale: f32,
}

impl Filter {
    fn new(size: u32) -> Self {
        let area = f64::from(size * size);
        Self { size, scale: (256.0 / area) as f32, mixed_scale: (0.9 * 256.0 / area) as f32 }
    }

    fn response(&self, integral: &IntegralImage, x: u32, y: u32) -> Response {
        let [xx, yy, xy] = derivatives(integral, x, y, self.size);
        // Each derivative is one correctly rounded product, so that all devices get the same integers.
        let nxx = (xx as f32 * self.scale).round_ties_even() as i32;
        let nyy = (yy as f32 * self.scale).round_ties_even() as i32;
        let nxy = (xy as f32 * self.mixed_scale).round_ties_even() as i32;
        Response::new(nxx * nyy - nxy * nxy, nxx + nyy > 0)
    }
}

/// The second derivatives `[Dxx, Dyy, Dxy]` by a filter of side `size` around `(x, y)`.
fn derivatives(integral: &IntegralImage, x: u32, y: u32, size: u32) -> [i32; 3] {
    let lobe = size / 3;
    let (border, side, middle) = (size / 2, lobe - 1, lobe / 2);
    let sum = |x0, y0, x1, y1| integral.box_sum(x0, y0, x1, y1) as i32;

    // Three lobes of weights 1, -2, 1: the whole filter minus three times the middle lobe.
    let xx = sum(x - border, y - side, x + border + 1, y + side + 1)
        - 3 * sum(x - middle, y - side, x + middle + 1, y + side + 1);
    let yy = sum(x - side, y - border, x + side + 1, y + border + 1)
        - 3 * sum(x - side, y - middle, x + side + 1, y + middle + 1);
    let xy = sum(x + 1, y - lobe, x + lobe + 1, y) + sum(x - lobe, y + 1, x, y + lobe + 1)
        - sum(x - lobe, y - lobe, x, y)
        - sum(x + 1, y + 1, x + lobe + 1, y + lobe + 1);
    [xx, yy, xy]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Luma;
    use crate::image::Size;

    fn integral(width: u32, height: u32, f: impl FnMut(u32, u32) -> u8) -> IntegralImage {
        IntegralImage::new(&Luma::from_fn((width, height), f))
    }

    fn impulse(x: u32, y: u32) -> IntegralImage {
        integral(19, 19, |px, py| if (px, py) == (x, y) { 100 } else { 0 })
    }

    #[test]
    fn an_impulse_has_the_weight_of_the_lobe_it_falls_into() {
        // Filter 9: lobes of 3 x 5 px for Dxx and Dyy, 3 x 3 for Dxy.
        assert_eq!(derivatives(&impulse(9, 9), 9, 9, 9), [-200, -200, 0]);
        assert_eq!(derivatives(&impulse(11, 9), 9, 9, 9), [100, -200, 0]);
        assert_eq!(derivatives(&impulse(12, 11), 9, 9, 9), [100, 0, -100]);
        assert_eq!(derivatives(&impulse(11, 7), 9, 9, 9), [100, 100, 100]);
        assert_eq!(derivatives(&impulse(13, 13), 9, 9, 9), [0, 0, 0]);
    }

    #[test]
    fn an_impulse_normalised_by_hand() {
        // -200 * 256 / 81 = -632.1: 632^2, light in the middle.
        let response = Filter::new(9).response(&impulse(9, 9), 9, 9);
        assert_eq!((response.determinant(), response.dark()), (632 * 632, false));
        // xx = yy = xy = 100: 316.05 -> 316 twice, 0.9 times that 284.4 -> 284; trace positive.
        let response = Filter::new(9).response(&impulse(11, 7), 9, 9);
        assert_eq!((response.determinant(), response.dark()), (316 * 316 - 284 * 284, true));
    }

    #[test]
    fn a_saddle_is_negative_and_survives_the_packing() {
        // xx = 100, yy = -200: 316 * -632.
        let response = Filter::new(9).response(&impulse(11, 9), 9, 9);
        assert_eq!((response.determinant(), response.dark()), (316 * -632, false));
    }

    #[test]
    fn a_straight_step_has_no_determinant() {
        let step = integral(40, 40, |x, _| if x < 20 { 0 } else { 200 });
        let octave = Octave::new(&step, 0, 1);
        assert!(octave.layers.iter().all(|layer| layer.data().iter().all(|word| word.determinant() == 0)));
        // Yet Dxx is not 0: one lobe of 3 x 5 px lies in the light, one pixel column short of it.
        assert_eq!(derivatives(&step, 18, 20, 9), [200 * 15, 0, 0]);
    }

    #[test]
    fn the_extreme_picture_does_not_overflow() {
        // The middle lobes of Dxx and Dyy overlap in 3 x 3; white there, black elsewhere, and the reverse.
        for (inside, outside) in [(255, 0), (0, 255)] {
            let cross = integral(387, 387, |x, y| {
                let near = |v: u32| v.abs_diff(193) <= 64;
                if near(x) && near(y) { inside } else { outside }
            });
            let response = Filter::new(387).response(&cross, 193, 193);
            assert!(response.determinant() > 0 && response.dark() == (inside == 0));
        }
    }

    #[test]
    fn a_filter_that_does_not_fit_gives_zero() {
        let noise = integral(9, 11, |x, y| (x * 31 + y * 57 + x * y * 7) as u8);
        let octave = Octave::new(&noise, 0, 1);
        let filled: Vec<_> = (0..11)
            .flat_map(|y| (0..9).map(move |x| (x, y)))
            .filter(|&(x, y)| octave.layers[0].get(x, y) != Response::default())
            .collect();
        assert_eq!(filled, [(4, 4), (4, 5), (4, 6)]);
        assert!(octave.layers[1].data().iter().all(|&word| word == Response::default()));
    }

    #[test]
    fn a_grid_reaches_the_last_pixel_it_can() {
        let octave = Octave::new(&integral(17, 16, |_, _| 0), 1, 2);
        assert_eq!((octave.spacing, octave.layers[3].size()), (4, Size::new(5, 4)));
    }
}
