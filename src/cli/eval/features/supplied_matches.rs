//! Matches and interest points of another program, from CSV files.

use std::path::Path;

use glam::DVec2;
use hsad::{
    Result,
    eval::{Point, PointMatch},
    image::Size,
    io::csv,
};

/// Largest distance between a match and its interest point, in pixels: rounding to whole pixels moves a position by
/// 0.71 px at most.
const SAME: f64 = 0.75;

/// Reads matches: columns x1, y1, x2, y2 in pixels, and optionally confidence. Without that column the lines are taken
/// to be in order of confidence, the most confident first.
pub fn matches(path: &Path, sizes: [Size; 2]) -> Result<Vec<PointMatch>> {
    let table = csv::read(path, &["x1", "y1", "x2", "y2"], &["confidence"])?;
    let matches = table.rows.iter().enumerate().map(|(i, (line, values))| {
        let &[x1, y1, x2, y2, ..] = &values[..] else { unreachable!("four columns were asked for") };
        inside(path, *line, [("x1", x1), ("y1", y1)], sizes[0])?;
        inside(path, *line, [("x2", x2), ("y2", y2)], sizes[1])?;
        let confidence = values.get(4).copied().unwrap_or(-(i as f64));
        Ok(PointMatch { first: DVec2::new(x1, y1), second: DVec2::new(x2, y2), confidence, points: None })
    });
    matches.collect()
}

/// Reads interest points as `hsad features` writes them: columns x, y and scale, in pixels.
pub fn points(path: &Path, size: Size) -> Result<Vec<Point>> {
    let table = csv::read(path, &["x", "y", "scale"], &[])?;
    let points = table.rows.iter().map(|(line, values)| {
        let &[x, y, scale] = &values[..] else { unreachable!("three columns were asked for") };
        inside(path, *line, [("x", x), ("y", y)], size)?;
        if scale <= 0.0 {
            return Err(csv::at(path, *line, format!("scale is {scale}, but it must be above 0")));
        }
        Ok(Point { at: DVec2::new(x, y), scale })
    });
    points.collect()
}

/// Assigns to every match the points it joins: in each view the nearest point. Of several points at one position, such
/// as one point with several orientations, the match takes the first that no earlier match has taken.
pub fn join(matches: &mut [PointMatch], points: [&[Point]; 2]) {
    let mut joined = points.map(|points| vec![0_usize; points.len()]);
    let nearest = |points: &[Point], joined: &[usize], place: DVec2| {
        let distance = |i: usize| points[i].at.distance_squared(place);
        let order = |a: usize, b: usize| distance(a).total_cmp(&distance(b)).then(joined[a].cmp(&joined[b]));
        (0..points.len()).min_by(|&a, &b| order(a, b)).filter(|&i| distance(i) <= SAME * SAME)
    };
    for found in matches {
        let [first, second] = &mut joined;
        found.points = match (nearest(points[0], first, found.first), nearest(points[1], second, found.second)) {
            (Some(i), Some(j)) => {
                first[i] += 1;
                second[j] += 1;
                Some([i, j])
            }
            _ => None,
        };
    }
}

fn inside(path: &Path, line: usize, [x, y]: [(&str, f64); 2], Size { width, height }: Size) -> Result<()> {
    for ((name, value), side, what) in [(x, width, "wide"), (y, height, "high")] {
        if !(-0.5..=f64::from(side) - 0.5).contains(&value) {
            return Err(csv::at(path, line, format!("{name} is {value}, but the picture is {side} px {what}")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_join_the_nearest_points_that_are_close() {
        let points = |x: f64| [0.0, 1.0, 5.0].map(|dx| Point { at: DVec2::new(x + dx, 7.0), scale: 1.0 });
        let found = |x1, x2| PointMatch {
            first: DVec2::new(x1, 7.5),
            second: DVec2::new(x2, 7.0),
            confidence: 0.0,
            points: None,
        };
        let mut matches = [found(10.9, 25.3), found(10.0, 22.0), found(17.0, 20.0)];
        join(&mut matches, [&points(10.0), &points(20.0)]);
        assert_eq!(matches.map(|found| found.points), [Some([1, 2]), None, None]);
        // Two points at one place take turns.
        let twice = [10.0, 10.0].map(|x| Point { at: DVec2::new(x, 7.0), scale: 1.0 });
        let mut matches = [found(10.0, 20.0); 3];
        join(&mut matches, [&twice, &points(20.0)]);
        assert_eq!(matches.map(|found| found.points), [Some([0, 0]), Some([1, 0]), Some([0, 0])]);
    }
}
