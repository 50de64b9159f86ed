//! Depths of disparities, as a table.

use crate::{
    calibration::Calibration,
    disparity::{DisparityRange, NONE, SCALE, pixels},
};

/// The depth of each disparity of a range, divided once on the host: devices divide floats each in a way of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthTable {
    /// The disparity of the first entry, in 1/256 px.
    first: i32,
    /// Depth in metres, and depth divided by the focal length: metres per pixel. 0 where a disparity has no depth.
    entries: Vec<[f32; 2]>,
}

impl DepthTable {
    /// The depths of the disparities of a map that was searched in `range`: interpolation adds up to half a pixel at either end.
    pub fn new(range: DisparityRange, calibration: &Calibration) -> Self {
        let [first, last] = [range.min - 1, range.last() + 1].map(|pixels| pixels * SCALE);
        let entries = (first..=last).map(|disparity| {
            let depth = pixels(disparity).and_then(|disparity| calibration.depth(disparity.into()));
            depth.map_or([0.0; 2], |depth| [depth as f32, (depth / calibration.focal) as f32])
        });
        Self { first, entries: entries.collect() }
    }

    /// The disparity of the first entry, in 1/256 px.
    pub fn first(&self) -> i32 {
        self.first
    }

    /// The disparity of the last entry, in 1/256 px.
    pub fn last(&self) -> i32 {
        self.first + self.entries.len() as i32 - 1
    }

    /// Depth in metres and metres per pixel at the depth of a disparity; 0 for both where it has none. A disparity outside the table has
    /// the entry at its end.
    pub fn at(&self, disparity: i32) -> [f32; 2] {
        match disparity {
            NONE => [0.0; 2],
            _ => self.entries[(disparity.clamp(self.first, self.last()) - self.first) as usize],
        }
    }

    /// The smallest disparity of a depth of at most `max_depth`, in metres; larger than any disparity if there is none.
    pub fn least(&self, calibration: &Calibration, max_depth: f64) -> i32 {
        let is_near = |disparity: &i32| {
            let depth = pixels(*disparity).and_then(|disparity| calibration.depth(disparity.into()));
            depth.is_some_and(|depth| depth <= max_depth)
        };
        (self.first..=self.last()).find(is_near).unwrap_or(i32::MAX)
    }

    /// The entries as the bits of floats.
    pub fn words(&self) -> Vec<u32> {
        self.entries.iter().flatten().map(|value| value.to_bits()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{calibration::depth_map, image::Plane, io::ply::PointFilter};

    #[test]
    fn depths_are_those_of_a_depth_map() {
        let calibration = Calibration::centred(300.0, 0.1, -2.5, (9, 9)).unwrap();
        let table = DepthTable::new(DisparityRange::inclusive(-4, 60).unwrap(), &calibration);
        assert_eq!([table.first(), table.last()], [-5 * 256, 61 * 256]);
        let disparities: Vec<i32> = (table.first()..=table.last()).chain([NONE]).collect();
        let map = Plane::new((disparities.len() as u32, 1), disparities).unwrap();
        let depths = depth_map(&map, &calibration);
        for (&disparity, &depth) in map.data().iter().zip(depths.data()) {
            assert_eq!(table.at(disparity)[0], if depth.is_finite() { depth } else { 0.0 }, "{disparity}");
        }
        assert_eq!((table.at(i32::MIN + 1), table.at(i32::MAX)), ([0.0; 2], table.at(table.last())));
        assert_eq!(table.at(5 * 256), [12.0, 0.04]);
        // Half a pixel is a tenth at 5 px, which are 7.5 px and doffs.
        let max_depth = PointFilter::new(&calibration).max_depth;
        assert_eq!(table.least(&calibration, max_depth), 7 * 256 + 128);
        assert_eq!(table.least(&calibration, f64::INFINITY), 2 * 256 + 129);
        assert_eq!(table.least(&calibration, 1e-3), i32::MAX);
    }
}
