//! Lengths in metres.

use std::path::Path;

use glam::DVec3;

use crate::{error::Result, io::malformed};

/// Longest baseline, in metres, that is believed where a format has metres, and no unit was named.
const FAR: f64 = 20.0;
/// Lengths of a baseline that are metres, and those that are millimetres, where a format has no unit.
const METRES: std::ops::RangeInclusive<f64> = 0.005..=2.0;
const MILLIMETRES: std::ops::RangeInclusive<f64> = 10.0..=5000.0;

/// The translation between the cameras of a format whose unit is the metre, or `unit` metres if the user says so.
pub(super) fn of_metres(translation: DVec3, unit: Option<f64>, path: &Path) -> Result<DVec3> {
    let metres = translation * unit.unwrap_or(1.0);
    if unit.is_none() && metres.length() > FAR {
        return Err(malformed(
            path,
            format!(
                "the baseline is {}, and lengths here are in metres: name the unit of length (0.001 for millimetres) if \
                 they are not",
                shown(metres.length())
            ),
        ));
    }
    Ok(metres)
}

/// The unit of length, in metres, of a format that has that of the calibration target, from the baseline's length in it.
pub(super) fn of_target(length: f64, unit: Option<f64>, path: &Path, notes: &mut Vec<String>) -> Result<f64> {
    let mut taken = |name: &str, unit: f64| {
        notes.push(format!("the baseline is {} in the file: taken as {name}", shown(length)));
        Ok(unit)
    };
    match unit {
        Some(unit) => Ok(unit),
        None if METRES.contains(&length) => taken("metres", 1.0),
        None if MILLIMETRES.contains(&length) => taken("millimetres", 1e-3),
        None => {
            let reason = format!(
                "the baseline is {}, in the unit of the squares of the chessboard: name the unit of length (0.001 for \
                 millimetres, 0.025 for squares of 25 mm)",
                shown(length)
            );
            Err(malformed(path, reason))
        }
    }
}

fn shown(length: f64) -> f64 {
    (1e4 * length).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_believed_guessed_or_asked_for() {
        let path = Path::new("rig.yml");
        let along = |length: f64| DVec3::new(-length, 0.0, 0.0);
        let mut notes = Vec::new();
        assert_eq!(of_metres(along(0.12), None, path).unwrap().x, -0.12);
        assert_eq!(of_metres(along(120.0), Some(1e-3), path).unwrap().x, -0.12);
        let error = of_metres(along(120.0), None, path).unwrap_err().to_string();
        assert!(error.contains("the baseline is 120, and lengths here are in metres"), "{error}");
        for (length, unit, expected) in [(0.12, None, 1.0), (120.0, None, 1e-3), (3.0, Some(0.025), 0.025)] {
            assert_eq!(of_target(length, unit, path, &mut notes).unwrap(), expected);
        }
        assert_eq!(
            notes,
            [
                "the baseline is 0.12 in the file: taken as metres",
                "the baseline is 120 in the file: taken as millimetres"
            ]
        );
        let error = of_target(3.0, None, path, &mut notes).unwrap_err().to_string();
        assert!(error.contains("the baseline is 3, in the unit of the squares"), "{error}");
        assert!(of_target(f64::NAN, None, path, &mut notes).is_err());
    }
}
