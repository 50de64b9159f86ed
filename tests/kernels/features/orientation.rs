use std::f32::consts::PI;

use hsad::{features::Keypoint, image::Luma, verify::trials::OrientationTrial};

use crate::common::{assert_twin, bench, keypoint, keypoints_of, picture, pictures};

fn at(picture: &Luma, points: &[[f32; 3]]) -> OrientationTrial {
    let keypoints = points.iter().map(|&[x, y, scale]| keypoint(x, y, scale)).collect();
    OrientationTrial { picture: picture.clone(), keypoints }
}

/// The orientations at points (x, y, scale).
fn orientations(picture: &Luma, points: &[[f32; 3]]) -> Vec<f32> {
    let trial = at(picture, points);
    let oriented = trial.oriented(&bench()).unwrap();
    for (found, input) in oriented.iter().zip(&trial.keypoints) {
        assert_eq!(Keypoint { orientation: input.orientation, ..*found }, *input, "only the orientation is written");
    }
    oriented.into_iter().map(|keypoint| keypoint.orientation).collect()
}

#[test]
fn ramps_point_where_they_rise() {
    for (dx, dy, expected) in [
        (2, 0, 0.0),
        (2, 2, PI / 4.0),
        (0, 2, PI / 2.0),
        (-2, 2, 3.0 * PI / 4.0),
        (-2, 0, PI),
        (-2, -2, 5.0 * PI / 4.0),
        (0, -2, 3.0 * PI / 2.0),
        (2, -2, 7.0 * PI / 4.0),
    ] {
        let picture = Luma::from_fn((61, 61), |x, y| (128 + dx * (x as i32 - 30) + dy * (y as i32 - 30)) as u8);
        let found = orientations(&picture, &[[30.0, 30.0, 2.0], [31.3, 29.6, 1.7]]);
        for angle in found {
            assert!((angle - expected).abs() < 0.01, "({dx}, {dy}): {angle}, not {expected}");
        }
    }
}

#[test]
fn no_gradient_has_no_direction() {
    assert_eq!(orientations(&Luma::filled((50, 50), 200), &[[25.0, 25.0, 2.0]]), [0.0]);
}

#[test]
fn keypoints_at_and_beyond_the_edge_are_in_range() {
    let picture = Luma::from_fn((40, 30), |x, y| (x * 5 + y * 3) as u8);
    for angle in orientations(&picture, &[[0.0, 0.0, 3.0], [39.0, 29.0, 30.0], [-5.0, 400.0, 1.2]]) {
        assert!((0.0..2.0 * PI).contains(&angle), "{angle}");
    }
}

/// More keypoints than one row of workgroups: none is left out.
#[test]
fn every_keypoint_of_many_gets_its_own() {
    let picture = Luma::from_fn((61, 61), |x, _| (4 * x) as u8);
    let points = vec![[30.0, 30.0, 2.0]; 700];
    let found = orientations(&picture, &points);
    assert!(found.iter().all(|angle| angle.abs() < 0.01), "{found:?}");
}

#[test]
fn equals_the_twin() {
    let mut total = 0;
    for (name, picture) in pictures() {
        let keypoints = keypoints_of(&picture, 0.000_1);
        total += keypoints.len();
        if !keypoints.is_empty() {
            assert_twin(&name, &OrientationTrial { picture, keypoints });
        }
    }
    assert!(total > 1000, "{total}");
}

/// Covers places beyond the edges, at any scale.
#[test]
fn equals_the_twin_anywhere() {
    let points: Vec<_> = (0..300).map(|n| n as f32).map(|n| [n % 97.3, n % 131.9, 1.2 + n / 7.0]).collect();
    assert_twin("noise", &at(&picture((97, 133), 11), &points));
}
