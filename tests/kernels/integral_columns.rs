use hsad::{
    features::integral_columns::IntegralColumns,
    image::{Luma, Plane},
    reference::{integral::IntegralImage, integral_columns::sum_columns, integral_rows::sum_rows},
};

use crate::common::{assert_same, download, gpu, integral_image, pictures, run, upload};

fn column_sums(sums: &Plane<u32>) -> Vec<u32> {
    let buffer = upload(sums.data());
    let stage = IntegralColumns::new(&gpu().device, &buffer, sums.width() - 1, sums.height() - 1);
    run(|encoder| stage.record(encoder));
    download(&buffer)
}

#[test]
fn two_by_three_with_a_sum_that_wraps() {
    let sums = Plane::new(2, 3, vec![1, u32::MAX, 2, 3, 4, 5]).unwrap();
    assert_eq!(column_sums(&sums), [1, u32::MAX, 3, 2, 7, 7]);
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        let mut sums = sum_rows(&picture);
        let found = column_sums(&sums);
        sum_columns(&mut sums);
        assert_same(&name, &found, sums.data());
    }
}

/// White sums to 6.12e9 here, beyond 2^32; every value is known without any summing.
#[test]
fn both_passes_wrap_at_24_megapixels() {
    let (width, height) = (6000, 4000);
    let found = download::<u32>(&integral_image(&Luma::filled(width, height, 255)));
    let expected = Plane::from_fn(width + 1, height + 1, |x, y| (255 * x).wrapping_mul(y));
    assert_same("white", &found, expected.data());
}

#[test]
fn both_passes_are_the_integral_image() {
    let picture = Luma::new(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap();
    let expected = [0, 0, 0, 0, 0, 1, 3, 6, 0, 5, 12, 21];
    assert_eq!(download::<u32>(&integral_image(&picture)), expected);
    assert_eq!(IntegralImage::new(&picture).sums().data(), expected);
}
