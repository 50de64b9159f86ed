//! Interest points of a picture turned by quarters of a turn, which moves pixels to pixels and interpolates nothing.

use glam::DVec2;
use hsad::{
    features::{Feature, FeatureConfig, detect},
    image::Luma,
    io::load::load,
};

use crate::common::{block_on, gpu};

/// Largest mean displacement along x and along y, in pixels: 0.013 was measured.
const BIAS: f64 = 0.02;
/// Largest median displacement, and the one that 95 % of the points stay below, in pixels: coarse octaves look at every second, fourth,
/// eighth pixel, which are others in a turned picture of most sizes. 0.0000 and 0.78 were measured.
const MEDIAN: f64 = 0.01;
const MOST: f64 = 1.0;
/// Smallest share of the points that are found again: 0.93 was measured.
const FOUND: f64 = 0.9;

/// The picture turned clockwise by as many quarters, and where a place of it was before.
fn turned(picture: &Luma, quarters: u32) -> (Luma, impl Fn(DVec2) -> DVec2) {
    let (width, height) = (picture.width(), picture.height());
    let (right, down) = (f64::from(width - 1), f64::from(height - 1));
    let before = move |place: DVec2| match quarters {
        1 => DVec2::new(place.y, down - place.x),
        2 => DVec2::new(right - place.x, down - place.y),
        3 => DVec2::new(right - place.y, place.x),
        _ => place,
    };
    let size = if quarters.is_multiple_of(2) { (width, height) } else { (height, width) };
    let turned = Luma::from_fn(size, |x, y| {
        let from = before(DVec2::new(x.into(), y.into()));
        picture.get(from.x as u32, from.y as u32)
    });
    (turned, before)
}

fn found(picture: &Luma, config: &FeatureConfig) -> Vec<Feature> {
    block_on(detect(gpu(), picture, config)).unwrap().features
}

#[test]
fn points_turn_with_the_picture() {
    for scene in ["planes", "curved"] {
        let path: std::path::PathBuf = [env!("CARGO_MANIFEST_DIR"), "data", scene, "left.png"].iter().collect();
        let whole = load(&path).unwrap().luma();
        // The octaves' grids lie differently in pictures of other sizes.
        for cut in 0..4 {
            let picture = Luma::from_fn((whole.width() - cut, whole.height() - cut), |x, y| whole.get(x, y));
            let config = FeatureConfig { threshold: 0.000_03, ..FeatureConfig::default() };
            let points = found(&picture, &config);
            for quarters in 1..4 {
                let (view, before) = turned(&picture, quarters);
                let again = found(&view, &config);
                let places: Vec<(DVec2, &Feature)> =
                    again.iter().map(|point| (before(DVec2::new(point.x.into(), point.y.into())), point)).collect();
                let offs: Vec<DVec2> = points
                    .iter()
                    .filter_map(|point| {
                        let place = DVec2::new(point.x.into(), point.y.into());
                        let alike = places.iter().filter(|(_, other)| {
                            other.dark == point.dark && (other.scale / point.scale - 1.0).abs() < 0.2
                        });
                        let off = alike.map(|(there, _)| *there - place);
                        off.min_by(|a, b| a.length().total_cmp(&b.length())).filter(|off| off.length() < 2.0)
                    })
                    .collect();
                let mean = offs.iter().sum::<DVec2>() / offs.len() as f64;
                let mut lengths: Vec<f64> = offs.iter().map(|off| off.length()).collect();
                lengths.sort_by(f64::total_cmp);
                let share = offs.len() as f64 / points.len() as f64;
                let [median, most] = [50, 95].map(|percent| lengths[lengths.len() * percent / 100]);
                let figures =
                    format!("{scene} - {cut}, {quarters} quarters: {share:.3}, {mean}, {median:.4}, {most:.3}");
                assert!(share > FOUND && mean.abs().max_element() < BIAS, "{figures}");
                assert!(median < MEDIAN && most < MOST, "{figures}");
            }
        }
    }
}
