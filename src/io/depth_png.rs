//! Depth as 16-bit grey PNG in millimetres, as depth cameras write it (the TUM RGB-D and ScanNet data, ROS' `16UC1` images).
//!
//! A value is the depth in millimetres, rounded, and 0 is no depth: depths below 0.5 mm and above 65.535 m have no value. A PFM
//! ([`super::pfm`]) holds all depths as they are.

use std::io::{self, Write};

use super::png;
use crate::image::Plane;

/// Metres per value.
pub const METRES_PER_VALUE: f64 = 0.001;

/// Pixels with a depth that millimetres in 16 bits cannot hold; they are written as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unheld {
    /// Number of pixels beyond 65.535 m.
    pub beyond: usize,
    /// Number of pixels nearer than half a millimetre.
    pub nearer: usize,
}

/// Depths in metres as millimetres; 0 where there is none, or none that fits.
pub fn millimetres(depth: &Plane<f32>) -> (Plane<u16>, Unheld) {
    let mut unheld = Unheld::default();
    let values = depth.map(|&metres| {
        let value = (f64::from(metres) / METRES_PER_VALUE).round();
        match value {
            _ if !metres.is_finite() || metres <= 0.0 => 0,
            1.0..=65_535.0 => value as u16,
            _ => {
                *if value < 1.0 { &mut unheld.nearer } else { &mut unheld.beyond } += 1;
                0
            }
        }
    });
    (values, unheld)
}

/// Writes depths in metres.
///
/// # Errors
/// The errors of `out`.
pub fn write(out: &mut impl Write, depth: &Plane<f32>) -> io::Result<Unheld> {
    let (values, unheld) = millimetres(depth);
    png::write_grey16(out, &values)?;
    Ok(unheld)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millimetres_by_hand() {
        let metres = [0.0004, 0.0006, 1.2345, 65.5354, 65.5356, 1e9, f32::INFINITY, f32::NAN, 0.0, -1.0];
        let depth = Plane::new((10, 1), metres.to_vec()).unwrap();
        let (values, unheld) = millimetres(&depth);
        // 1.2345 as a float lies just above.
        assert_eq!(values.data(), [0, 1, 1235, 65_535, 0, 0, 0, 0, 0, 0]);
        assert_eq!(unheld, Unheld { beyond: 2, nearer: 1 });
        let mut bytes = Vec::new();
        assert_eq!(write(&mut bytes, &depth).unwrap(), unheld);
        let read = ::image::load_from_memory(&bytes).unwrap();
        assert_eq!(read.as_luma16().unwrap().as_raw(), values.data());
    }
}
