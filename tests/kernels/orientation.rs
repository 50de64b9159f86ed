use std::f32::consts::PI;

use hsad::{
    features::{
        dispatch::Dispatch,
        integral::Integral,
        keypoints::{Keypoint, list_buffer},
        orientation::Orientation,
    },
    image::Luma,
};

use crate::common::{download, gpu, poison, run, upload_luma, write};

/// The orientations at points (x, y, scale).
fn orientations(picture: &Luma, points: &[[f32; 3]]) -> Vec<f32> {
    let device = &gpu().device;
    let (width, height) = picture.size();
    let integral = Integral::new(device, &upload_luma(picture), width, height).unwrap();
    let list = list_buffer(device, points.len() as u32).unwrap();
    let keypoints = points.iter().map(|&[x, y, scale]| Keypoint { x, y, scale, response: 0, octave: 0, index: 0 });
    let mut bytes = (points.len() as u32).to_ne_bytes().to_vec();
    keypoints.for_each(|keypoint| bytes.extend(bytemuck::bytes_of(&keypoint)));
    write(&list, &bytes);
    let dispatch = Dispatch::new(device, &list);
    let stage = Orientation::new(device, integral.integral(), &list, (width, height), points.len() as u32).unwrap();
    poison(stage.orientations());
    run(|encoder| {
        integral.record(encoder);
        dispatch.record(encoder);
        stage.record(encoder, dispatch.groups());
    });
    download(stage.orientations())
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
        let picture = Luma::from_fn(61, 61, |x, y| (128 + dx * (x as i32 - 30) + dy * (y as i32 - 30)) as u8);
        let found = orientations(&picture, &[[30.0, 30.0, 2.0], [31.3, 29.6, 1.7]]);
        for angle in found {
            assert!((angle - expected).abs() < 0.01, "({dx}, {dy}): {angle}, not {expected}");
        }
    }
}

#[test]
fn no_gradient_has_no_direction() {
    assert_eq!(orientations(&Luma::filled(50, 50, 200), &[[25.0, 25.0, 2.0]]), [0.0]);
}

#[test]
fn keypoints_at_and_beyond_the_edge_are_in_range() {
    let picture = Luma::from_fn(40, 30, |x, y| (x * 5 + y * 3) as u8);
    for angle in orientations(&picture, &[[0.0, 0.0, 3.0], [39.0, 29.0, 30.0], [-5.0, 400.0, 1.2]]) {
        assert!((0.0..2.0 * PI).contains(&angle), "{angle}");
    }
}

/// More keypoints than one row of workgroups holds: none is left out.
#[test]
fn every_keypoint_of_many_gets_its_own() {
    let picture = Luma::from_fn(61, 61, |x, _| (4 * x) as u8);
    let points = vec![[30.0, 30.0, 2.0]; 700];
    let found = orientations(&picture, &points);
    assert!(found.iter().all(|angle| angle.abs() < 0.01), "{found:?}");
}
