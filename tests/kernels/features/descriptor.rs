use std::f32::consts::PI;

use hsad::{
    features::{DESCRIPTOR_LENGTH, Keypoint},
    image::Luma,
    internals::cpu::features::{haar::QuantizedPoint, integral::IntegralImage, orientation::orientation},
    verify::{Values, trials::DescriptorTrial},
};

use crate::common::{assert_twin, keypoint, keypoints_of, leaves, picture, pictures};

fn described(picture: &Luma, keypoints: &[Keypoint], upright: bool) -> Vec<[f32; DESCRIPTOR_LENGTH]> {
    let left = leaves(&DescriptorTrial { picture: picture.clone(), keypoints: keypoints.to_vec(), upright });
    let [Values::F32(values)] = &left[..] else { panic!("64 floats a keypoint") };
    values.as_chunks().0.to_vec()
}

/// Keypoints at points (x, y, scale, orientation).
fn at(points: &[[f32; 4]]) -> Vec<Keypoint> {
    let keypoint = |&[x, y, scale, orientation]: &[f32; 4]| Keypoint { orientation, ..keypoint(x, y, scale) };
    points.iter().map(keypoint).collect()
}

/// The descriptors at points (x, y, scale, orientation).
fn descriptors(picture: &Luma, points: &[[f32; 4]]) -> Vec<[f32; DESCRIPTOR_LENGTH]> {
    described(picture, &at(points), false)
}

/// The upright descriptors at points (x, y, scale, ignored).
fn upright(picture: &Luma, points: &[[f32; 4]]) -> Vec<[f32; DESCRIPTOR_LENGTH]> {
    described(picture, &at(points), true)
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
    let picture = Luma::from_fn((101, 101), |x, _| (2 * x) as u8);
    let points = &[[50.0, 50.0, 2.0, 0.0]];
    let side = [(-0.5_f32).exp(), (-1.0_f32 / 18.0).exp(), (-1.0_f32 / 18.0).exp(), (-0.5_f32).exp()];
    // Each value occurs twice, as dx and |dx|; the squares of the products sum to (sum of g^2)^2.
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
    let down = Luma::from_fn((101, 101), |_, y| (200 - 2 * y) as u8);
    let found = upright(&down, &[[50.0, 50.0, 2.0, 0.0]])[0];
    for cell in found.chunks(4) {
        assert!(cell[0] == 0.0 && cell[2] == 0.0 && cell[1] < 0.0 && cell[3] == -cell[1], "{cell:?}");
    }
}

#[test]
fn the_orientation_turns_the_grid_and_the_responses() {
    // A picture, and the picture turned by a quarter: (x, y) of the first is (60 - y, x) of the second.
    let level = picture((61, 61), 5);
    let turned = Luma::from_fn((61, 61), |x, y| level.get(y, 60 - x));
    let first = descriptors(&level, &[[30.0, 30.0, 2.0, 0.0]])[0];
    let second = descriptors(&turned, &[[30.0, 30.0, 2.0, PI / 2.0]])[0];
    assert_close(&second, &first, 1e-3);
    let unturned = descriptors(&turned, &[[30.0, 30.0, 2.0, 0.0]])[0];
    assert!(unturned.iter().zip(&first).any(|(a, b)| (a - b).abs() > 0.05));
}

#[test]
fn flat_surroundings_have_no_descriptor() {
    let flat = Luma::filled((80, 80), 77);
    assert_eq!(descriptors(&flat, &[[40.0, 40.0, 2.0, 1.0]])[0], [0.0; DESCRIPTOR_LENGTH]);
    assert_eq!(upright(&flat, &[[40.0, 40.0, 2.0, 0.0]])[0], [0.0; DESCRIPTOR_LENGTH]);
}

#[test]
fn everything_else_has_unit_length_even_beyond_the_edge() {
    let points: Vec<_> = (0..600).map(|n| n as f32).map(|n| [n % 97.0, n % 31.0, 1.2 + n / 50.0, n / 100.0]).collect();
    for (found, point) in descriptors(&picture((97, 33), 4), &points).iter().zip(&points) {
        let length = found.iter().map(|v| v * v).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-4, "{length} at {point:?}");
    }
}

fn assert_equals_the_twin(name: &str, picture: &Luma, keypoints: &[Keypoint]) {
    for upright in [true, false] {
        let (picture, keypoints) = (picture.clone(), keypoints.to_vec());
        assert_twin(&format!("{name}, upright {upright}"), &DescriptorTrial { picture, keypoints, upright });
    }
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        let integral = IntegralImage::new(&picture);
        let mut keypoints = keypoints_of(&picture, 0.000_1);
        for keypoint in &mut keypoints {
            keypoint.orientation = orientation(&integral, QuantizedPoint::new(keypoint.x, keypoint.y, keypoint.scale));
        }
        if !keypoints.is_empty() {
            assert_equals_the_twin(&name, &picture, &keypoints);
        }
    }
}

/// Covers places beyond the edges, at any scale and orientation.
#[test]
fn equals_the_twin_anywhere() {
    let points: Vec<_> = (0..300).map(|n| n as f32).map(|n| [n % 97.3, n % 131.9, 1.2 + n / 7.0, n / 50.0]).collect();
    assert_equals_the_twin("noise", &picture((97, 133), 11), &at(&points));
}
