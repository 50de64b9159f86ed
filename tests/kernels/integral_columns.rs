use hsad::{features::integral::Integral, image::Luma};

use crate::common::{SIZES, download, gpu, picture, poison, run, upload_luma};

fn integral_of(picture: &Luma) -> Vec<u32> {
    let (width, height) = picture.size();
    let stage = Integral::new(&gpu().device, &upload_luma(picture), width, height).unwrap();
    poison(stage.integral());
    run(|encoder| stage.record(encoder));
    download(stage.integral())
}

#[test]
fn three_by_two() {
    let picture = Luma::new(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap();
    #[rustfmt::skip]
    let expected = [
        0, 0,  0,  0,
        0, 1,  3,  6,
        0, 5, 12, 21,
    ];
    assert_eq!(integral_of(&picture), expected);
}

/// The zeros above and to the left, and every pixel as the box around it, fix the whole of it.
#[test]
fn boxes_of_one_pixel_give_the_picture_back_at_every_size() {
    for (width, height) in SIZES {
        let picture = picture(width, height, 1);
        let integral = integral_of(&picture);
        let at = |x: u32, y: u32| integral[(y * (width + 1) + x) as usize];
        assert!((0..=width).all(|x| at(x, 0) == 0) && (0..=height).all(|y| at(0, y) == 0), "{width}x{height}");
        let boxes = Luma::from_fn(width, height, |x, y| {
            (at(x + 1, y + 1).wrapping_sub(at(x, y + 1)).wrapping_sub(at(x + 1, y)).wrapping_add(at(x, y))) as u8
        });
        assert_eq!(boxes, picture, "{width}x{height}");
        let total: u32 = picture.data().iter().map(|&grey| u32::from(grey)).sum();
        assert_eq!(at(width, height), total, "{width}x{height}");
    }
}
