use hsad::{features::integral_rows::IntegralRows, image::Luma, reference::integral_rows::sum_rows};

use crate::common::{assert_same, download, gpu, pictures, poison, run, upload_luma};

fn row_sums(picture: &Luma) -> Vec<u32> {
    let (width, height) = picture.size();
    let stage = IntegralRows::new(&gpu().device, &upload_luma(picture), width, height).unwrap();
    poison(stage.sums());
    run(|encoder| stage.record(encoder));
    download(stage.sums())
}

#[test]
fn three_by_two() {
    let picture = Luma::new(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap();
    #[rustfmt::skip]
    let expected = [
        0, 0, 0,  0,
        0, 1, 3,  6,
        0, 4, 9, 15,
    ];
    assert_eq!(row_sums(&picture), expected);
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        assert_same(&name, &row_sums(&picture), sum_rows(&picture).data());
    }
}
