use hsad::{
    image::{Luma, Plane},
    internals::{
        cpu::features::{integral::IntegralImage, integral_rows::integral_rows},
        features::{integral_columns::IntegralColumns, integral_rows::IntegralRows},
    },
    verify::trials::ColumnsTrial,
};

use crate::common::{assert_same, assert_twin, bench, download, gpu, leaves, pictures};

#[test]
fn two_by_three_with_a_sum_that_wraps() {
    let sums = Plane::new((2, 3), vec![1, u32::MAX, 2, 3, 4, 5]).unwrap();
    assert_eq!(leaves(&ColumnsTrial(sums)), [vec![1, u32::MAX, 3, 2, 7, 7].into()]);
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        assert_twin(&name, &ColumnsTrial(integral_rows(&picture)));
    }
}

/// Both passes, one after the other.
fn integral_image(picture: &Luma) -> Vec<u32> {
    let (size, luma) = (picture.size(), bench().upload_luma(picture).unwrap());
    let sums = bench().output((IntegralRows::bytes(size) / 4) as u32).unwrap();
    let rows = IntegralRows::new(gpu()).prepare(size, &luma, &sums);
    let columns = IntegralColumns::new(gpu()).prepare(size, &sums);
    bench().run(|encoder| {
        rows.record(encoder);
        columns.record(encoder);
    });
    download(&sums)
}

/// White sums to 6.12e9 here, beyond 2^32; every value is known without any summing.
#[test]
fn both_passes_wrap_at_24_megapixels() {
    let (width, height) = (6000, 4000);
    let found = integral_image(&Luma::filled((width, height), 255));
    let expected = Plane::from_fn((width + 1, height + 1), |x, y| (255 * x).wrapping_mul(y));
    assert_same("white", &found, expected.data());
}

#[test]
fn both_passes_are_the_integral_image() {
    let picture = Luma::new((3, 2), vec![1, 2, 3, 4, 5, 6]).unwrap();
    let expected = [0, 0, 0, 0, 0, 1, 3, 6, 0, 5, 12, 21];
    assert_eq!(integral_image(&picture), expected);
    assert_eq!(IntegralImage::new(&picture).sums().data(), expected);
}
