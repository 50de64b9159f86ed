use hsad::{image::Luma, verify::trials::RowsTrial};

use crate::common::{assert_twin, leaves, pictures};

#[test]
fn three_by_two() {
    let picture = Luma::new((3, 2), vec![1, 2, 3, 4, 5, 6]).unwrap();
    #[rustfmt::skip]
    let expected: Vec<u32> = vec![
        0, 0, 0,  0,
        0, 1, 3,  6,
        0, 4, 9, 15,
    ];
    assert_eq!(leaves(&RowsTrial(picture)), [expected.into()]);
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        assert_twin(&name, &RowsTrial(picture));
    }
}
