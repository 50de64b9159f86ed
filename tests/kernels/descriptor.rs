use std::f32::consts::PI;

use hsad::{
    features::{
        DESCRIPTOR_LENGTH,
        descriptor::Descriptor,
        dispatch::Dispatch,
        integral::Integral,
        keypoints::{Keypoint, list_buffer},
    },
    image::Luma,
    wgpu,
};

use crate::common::{download, gpu, picture, poison, run, upload, upload_luma, write};

type Values = [f32; DESCRIPTOR_LENGTH];

/// The descriptors at points (x, y, scale, orientation).
fn descriptors(picture: &Luma, points: &[[f32; 4]]) -> Vec<Values> {
    let angles = upload(&points.iter().map(|point| point[3]).collect::<Vec<_>>());
    described(picture, points, Some(&angles))
}

/// The descriptors at points (x, y, scale, whatever), upright.
fn upright(picture: &Luma, points: &[[f32; 4]]) -> Vec<Values> {
    described(picture, points, None)
}

fn described(picture: &Luma, points: &[[f32; 4]], orientations: Option<&wgpu::Buffer>) -> Vec<Values> {
    let device = &gpu().device;
    let (width, height) = picture.size();
    let integral = Integral::new(device, &upload_luma(picture), width, height).unwrap();
    let list = list_buffer(device, points.len() as u32).unwrap();
    let keypoints = points.iter().map(|&[x, y, scale, _]| Keypoint { x, y, scale, response: 0, octave: 0, index: 0 });
    let mut bytes = (points.len() as u32).to_ne_bytes().to_vec();
    keypoints.for_each(|keypoint| bytes.extend(bytemuck::bytes_of(&keypoint)));
    write(&list, &bytes);
    let dispatch = Dispatch::new(device, &list);
    let stage = Descriptor::new(device, integral.integral(), &list, orientations, (width, height), points.len() as u32)
        .unwrap();
    poison(stage.descriptors());
    run(|encoder| {
        integral.record(encoder);
        dispatch.record(encoder);
        stage.record(encoder, dispatch.groups());
    });
    download(stage.descriptors())
}

#[track_caller]
fn assert_close(actual: &[f32], expected: &[f32], tolerance: f32) {
    for (i, (a, e)) in actual.iter().zip(expected).enumerate() {
        assert!((a - e).abs() <= tolerance, "value {i} is {a}, not {e}");
    }
}

/// On a ramp every sample's response is the same, so a subregion's value is its Gaussian, and the
/// descriptor's is their products: with g = exp(-1.5^2 / 4.5) : exp(-0.5^2 / 4.5) along each side.
#[test]
fn a_ramp_shows_the_gaussian_of_the_subregions() {
    let picture = Luma::from_fn(101, 101, |x, _| (2 * x) as u8);
    let points = &[[50.0, 50.0, 2.0, 0.0]];
    let side = [(-0.5_f32).exp(), (-1.0_f32 / 18.0).exp(), (-1.0_f32 / 18.0).exp(), (-0.5_f32).exp()];
    // Each value stands twice, as dx and |dx|; the squares of the products sum to (sum of g^2)^2.
    let length = 2.0_f32.sqrt() * side.iter().map(|g| g * g).sum::<f32>();
    let mut expected = Vec::new();
    for row in side {
        for column in side {
            let value = row * column / length;
            expected.extend([value, 0.0, value, 0.0]);
        }
    }
    assert_close(&descriptors(&picture, points)[0], &expected, 1e-5);
    assert_close(&upright(&picture, points)[0], &expected, 1e-5);
}

#[test]
fn signs_follow_the_rise() {
    let down = Luma::from_fn(101, 101, |_, y| (200 - 2 * y) as u8);
    let found = upright(&down, &[[50.0, 50.0, 2.0, 0.0]])[0];
    for cell in found.chunks(4) {
        assert!(cell[0] == 0.0 && cell[2] == 0.0 && cell[1] < 0.0 && cell[3] == -cell[1], "{cell:?}");
    }
}

#[test]
fn the_orientation_turns_the_grid_and_the_responses() {
    // A picture and the same turned by a quarter: (x, y) of the first is (60 - y, x) of the second.
    let level = picture(61, 61, 5);
    let turned = Luma::from_fn(61, 61, |x, y| level.get(y, 60 - x));
    let first = descriptors(&level, &[[30.0, 30.0, 2.0, 0.0]])[0];
    let second = descriptors(&turned, &[[30.0, 30.0, 2.0, PI / 2.0]])[0];
    // A sample's position may round to the next 1/16 px.
    assert_close(&second, &first, 0.01);
    let unturned = descriptors(&turned, &[[30.0, 30.0, 2.0, 0.0]])[0];
    assert!(unturned.iter().zip(&first).any(|(a, b)| (a - b).abs() > 0.05));
}

/// The kernel that shares corners against the one that does not.
#[test]
fn no_rotation_and_a_rotation_of_0_are_the_same() {
    let picture = picture(97, 133, 11);
    let points: Vec<_> = (0..300).map(|n| n as f32).map(|n| [n % 97.3, n % 131.9, 1.2 + n / 37.0, 0.0]).collect();
    for (found, expected) in upright(&picture, &points).iter().zip(descriptors(&picture, &points)) {
        assert_close(found, &expected, 1e-5);
    }
}

#[test]
fn flat_surroundings_have_no_descriptor() {
    let flat = Luma::filled(80, 80, 77);
    assert_eq!(descriptors(&flat, &[[40.0, 40.0, 2.0, 1.0]])[0], [0.0; DESCRIPTOR_LENGTH]);
    assert_eq!(upright(&flat, &[[40.0, 40.0, 2.0, 0.0]])[0], [0.0; DESCRIPTOR_LENGTH]);
}

#[test]
fn everything_else_has_unit_length_even_beyond_the_edge() {
    let points: Vec<_> = (0..600).map(|n| n as f32).map(|n| [n % 97.0, n % 31.0, 1.2 + n / 50.0, n / 100.0]).collect();
    for (found, point) in descriptors(&picture(97, 33, 4), &points).iter().zip(&points) {
        let length = found.iter().map(|v| v * v).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-4, "{length} at {point:?}");
    }
}
