//! Synthetic cameras: what they show, and what is made of it.

use glam::{DMat3, DVec2, DVec3};

use super::{linear::rotation, *};

const SIZE: Size = Size::new(800, 600);
const FOCAL: f64 = 900.0;

/// Two cameras, of which the left one stands in the origin, and a scene.
#[derive(Clone, Copy)]
struct Rig {
    /// Turns of the left and the right camera, rotation vectors in degrees.
    turns: [DVec3; 2],
    /// Place of the right camera, in metres.
    place: DVec3,
    /// Focal lengths over 900 px.
    zooms: [f64; 2],
    /// Distortions of the left and the right lens.
    k1: [f64; 2],
    /// Depth of the scene in metres, nearest and furthest.
    depths: [f64; 2],
}

/// Cameras side by side, 20 cm apart.
const SIDE_BY_SIDE: Rig = Rig {
    turns: [DVec3::ZERO; 2],
    place: DVec3::new(0.2, 0.0, 0.0),
    zooms: [1.0; 2],
    k1: [0.0; 2],
    depths: [2.0, 6.0],
};

impl Rig {
    fn turned(right: [f64; 3]) -> Self {
        Self { turns: [DVec3::ZERO, right.into()], ..SIDE_BY_SIDE }
    }

    /// Pixel of a place in a view, `None` beyond the picture.
    fn seen(&self, view: usize, place: DVec3) -> Option<DVec2> {
        let turn = rotation(self.turns[view] * (std::f64::consts::PI / 180.0));
        let place = turn * (place - [DVec3::ZERO, self.place][view]);
        let straight = place.truncate() / place.z * FOCAL * self.zooms[view];
        let centre = DVec2::new(399.5, 299.5);
        let side = 700.0;
        let pixel = centre + straight * (1.0 + self.k1[view] * straight.length_squared() / (side * side));
        let inside = (pixel - centre).abs().cmple(centre).all();
        (place.z > 0.0 && inside).then_some(pixel)
    }

    /// Points of both views, to within `noise` px, and places of the scene that both show.
    fn points(&self, count: usize, noise: f64) -> Vec<Correspondence> {
        let mut random = random();
        let mut points = Vec::new();
        for _ in 0..100 * count {
            let depth = self.depths[0] + (self.depths[1] - self.depths[0]) * random();
            let ray = DVec3::new((random() - 0.5) * 1.6, (random() - 0.5) * 1.6, 1.0);
            let ray = rotation(self.turns[0] * (-std::f64::consts::PI / 180.0)) * ray;
            let (Some(left), Some(right)) = (self.seen(0, ray * depth), self.seen(1, ray * depth)) else { continue };
            let mut off = || noise * (DVec2::new(random(), random()) - 0.5) * 2.0;
            points.push(Correspondence { left: left + off(), right: right + off() });
            if points.len() == count {
                break;
            }
        }
        points
    }

    /// 300 points to a third of a pixel, of which every fifth or so is wrong.
    fn matched(&self) -> Vec<Correspondence> {
        let mut random = random();
        let mut points = self.points(300, 0.35);
        for (index, point) in points.iter_mut().enumerate() {
            if index % 7 == 3 {
                point.right = DVec2::new(800.0 * random(), 600.0 * random());
            }
        }
        points
    }

    /// The rectification, and the largest row error of 95 % of true correspondences.
    fn rectified(&self) -> (Uncalibrated, f64) {
        let found = Uncalibrated::new(&self.matched(), [SIZE; 2], 1).unwrap();
        let mut errors: Vec<f64> = self
            .points(900, 0.0)
            .iter()
            .map(|point| (found.rectified(0, point.left).unwrap().y - found.rectified(1, point.right).unwrap().y).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let off = errors[errors.len() * 95 / 100];
        (found, off)
    }

    fn refused(&self) -> Refusal {
        Uncalibrated::new(&self.matched(), [SIZE; 2], 1).unwrap_err()
    }

    fn relation(&self) -> Relation {
        match self.refused() {
            Refusal::Relation(evidence) => evidence.relation,
            other => panic!("{other}"),
        }
    }
}

/// The pixel in the middle of a view.
const MIDDLE: DVec2 = DVec2::new(400.0, 300.0);

fn is_whole(coordinate: f64) -> bool {
    (coordinate - coordinate.round()).abs() < 1e-6
}

/// Numbers from 0 to 1 in a fixed sequence.
fn random() -> impl FnMut() -> f64 {
    let mut state = 7u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn rows_of_one_view_are_enough_for_turns_of_the_right_camera() {
    for (turn, kind) in [
        ([0.0, 0.0, 0.0], RowKind::AsIs),
        ([0.0, 0.0, 5.0], RowKind::Affine),
        ([0.0, 0.0, 30.0], RowKind::Affine),
        ([0.0, 0.0, 90.0], RowKind::Affine),
        ([0.0, 0.0, 180.0], RowKind::Affine),
        ([4.0, 0.0, 0.0], RowKind::Projective),
        ([0.0, 6.0, 0.0], RowKind::Projective),
        ([-3.0, 4.0, 12.0], RowKind::Projective),
    ] {
        let (found, off) = Rig::turned(turn).rectified();
        assert_eq!(found.model, Model::Right(kind), "{turn:?}");
        assert!(off < 0.4, "{turn:?}: {off}");
        assert_eq!((found.k1, found.size), ([0.0; 2], SIZE));
        let corner = DVec2::new(12.0, 34.0);
        assert!(found.rectified(0, corner).unwrap().abs_diff_eq(corner, 1e-9), "the left view stays");
        assert!(found.distortion.aspect < 1.2 && found.residual.most < 1.0, "{:?}", found.residual);
        assert!(found.keeps_columns || is_whole(found.rectified(1, MIDDLE).unwrap().x), "{turn:?}");
    }
}

#[test]
fn a_scale_is_undone_from_one_view() {
    for zoom in [0.5, 0.7, 1.5] {
        let (found, off) = Rig { zooms: [1.0, zoom], ..SIDE_BY_SIDE }.rectified();
        assert_eq!(found.model, Model::Right(RowKind::Affine));
        assert!(off < 0.4, "{zoom}: {off}");
        let [by_x, by_y] = [DVec2::X, DVec2::Y].map(|step| {
            found.rectified(1, DVec2::splat(300.0) + step).unwrap() - found.rectified(1, DVec2::splat(300.0)).unwrap()
        });
        assert!(
            (by_x.length() * zoom - 1.0).abs() < 0.02 && (by_y.length() * zoom - 1.0).abs() < 0.02,
            "{by_x} {by_y}"
        );
    }
}

#[test]
fn columns_that_lean_or_are_stretched_are_set_upright() {
    // Surfaces of 100 x 100 px that face the cameras.
    let mut random = random();
    let points: Vec<(DVec2, f64)> = (0..500)
        .map(|_| {
            let left = DVec2::new(150.0 + 600.0 * random(), 20.0 + 560.0 * random());
            let surface = (left / 100.0).floor();
            (left, 20.0 + 13.0 * ((3.0 * surface.x + 5.0 * surface.y) % 7.0))
        })
        .collect();
    for (across, down) in [(0.0, 0.0), (0.0, 0.15), (0.1, -0.2)] {
        let sheared = |(left, disparity): &(DVec2, f64)| {
            let right = *left - DVec2::new(*disparity, 0.0);
            let off = right - DVec2::new(399.5, 299.5);
            Correspondence { left: *left, right: right + DVec2::new(across * off.x + down * off.y, 0.0) }
        };
        let found = Uncalibrated::new(&points.iter().map(sheared).collect::<Vec<_>>(), [SIZE; 2], 1).unwrap();
        assert_eq!(found.model, Model::Right(RowKind::AsIs));
        let largest = points.iter().map(|point| {
            let right = found.rectified(1, sheared(point).right).unwrap();
            (point.0.x - right.x - point.1).abs()
        });
        assert!(largest.fold(0.0, f64::max) < 5.0, "{across} {down}");
        assert_eq!(found.keeps_columns, across == 0.0 && down == 0.0);
    }
}

/// A match is as precise in a view of few pixels as in one of many, and its errors are enlarged with the view.
#[test]
fn rows_of_a_small_scale_are_judged_by_its_own_pixels() {
    for zooms in [[1.0, 0.35], [0.35, 1.0]] {
        let points = Rig { zooms, depths: [1.0, 4.0], ..SIDE_BY_SIDE }.points(400, 0.55);
        let found = Uncalibrated::new(&points, [SIZE; 2], 1);
        assert!(found.is_ok(), "{zooms:?}: {}", found.unwrap_err());
    }
}

#[test]
fn columns_of_a_cropped_view_stay() {
    // Rolled by less than moves columns.
    let rolled = Rig::turned([0.0, 0.0, 0.1]).matched().into_iter();
    let cropped = rolled.map(|point| Correspondence { right: point.right - DVec2::new(10.0, 0.0), ..point });
    let found = Uncalibrated::new(&cropped.collect::<Vec<_>>(), [SIZE, Size::new(790, 600)], 1).unwrap();
    let moved = found.rectified(1, DVec2::new(123.0, 45.0)).unwrap();
    assert!(found.model == Model::Right(RowKind::Affine) && found.keeps_columns, "{:?}", found.model);
    assert!((moved.x - 123.0).abs() < 1e-9, "{moved}");
    let points = SIDE_BY_SIDE.matched();
    for (left, top, right, below) in [(0.0, 0.0, 10, 5), (10.0, 5.0, 0, 0), (0.0, 5.0, 10, 0), (10.0, 0.0, 0, 5)] {
        let cut = |point: &Correspondence| Correspondence { right: point.right - DVec2::new(left, top), ..*point };
        let cropped: Vec<Correspondence> = points.iter().map(cut).collect();
        let size = Size::new(800 - right - left as u32, 600 - below - top as u32);
        let found = Uncalibrated::new(&cropped, [SIZE, size], 1).unwrap();
        let kind = if top == 0.0 { RowKind::AsIs } else { RowKind::Shift };
        assert_eq!((found.model, found.keeps_columns, found.shift), (Model::Right(kind), true, 0.0));
        let (pixel, moved) = (DVec2::new(123.0, 45.0), found.rectified(1, DVec2::new(123.0, 45.0)).unwrap());
        assert!((moved.x - pixel.x).abs() < 1e-9 && (moved.y - pixel.y - top).abs() < 0.1, "{moved}");
    }
    assert!(!Rig::turned([0.0, 0.0, 5.0]).rectified().0.keeps_columns);
    assert!(!Rig { place: DVec3::new(0.0, 0.2, 0.0), ..SIDE_BY_SIDE }.rectified().0.keeps_columns, "both views");
}

#[test]
fn both_views_are_turned_where_neither_has_level_epipolar_lines() {
    let above = Rig { place: DVec3::new(0.0, 0.2, 0.0), ..SIDE_BY_SIDE };
    let askew = Rig { place: DVec3::new(0.15, 0.1, 0.0), ..SIDE_BY_SIDE };
    let rolled = Rig { turns: [DVec3::Z * 10.0, DVec3::Z * -10.0], ..SIDE_BY_SIDE };
    let converging = Rig { turns: [DVec3::new(3.0, 8.0, 0.0), DVec3::new(-2.0, -8.0, 6.0)], ..SIDE_BY_SIDE };
    for (rig, name) in [(above, "above"), (askew, "askew"), (rolled, "rolled"), (converging, "converging")] {
        let (found, off) = rig.rectified();
        assert_eq!(found.model, Model::Both, "{name}");
        assert!(off < 0.5, "{name}: {off}");
        assert!(found.distortion.aspect < 1.3 && found.distortion.skew < 10.0, "{name}: {:?}", found.distortion);
        let disparities = rig
            .points(100, 0.0)
            .into_iter()
            .filter(|point| found.rectified(0, point.left).unwrap().x > found.rectified(1, point.right).unwrap().x);
        assert_eq!(disparities.count(), 100, "{name}: the left camera stands on the left");
        let [left, right] = [0, 1].map(|view| found.rectified(view, MIDDLE).unwrap());
        assert!(is_whole(left.x) && is_whole(left.y) && is_whole(right.x), "{name}: {left} {right}");
        // Nothing that both views show is cut off.
        let inside = |view: usize, pixel: DVec2| {
            let there = found.rectified(view, pixel).unwrap();
            there.cmpge(DVec2::splat(-0.5)).all()
                && there.x < f64::from(found.size.width)
                && there.y < f64::from(found.size.height)
        };
        let points = rig.points(500, 0.0);
        let cut = points.iter().filter(|point| !inside(0, point.left) || !inside(1, point.right)).count();
        assert!(cut < 10, "{name}: {cut} of 500");
    }
}

#[test]
fn the_distortion_of_the_lens_is_found_and_undone() {
    for k1 in [-0.2, 0.1] {
        let rig =
            Rig { k1: [k1; 2], turns: [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)], depths: [1.0, 4.0], ..SIDE_BY_SIDE };
        let (found, off) = rig.rectified();
        assert!(
            found.k1[0] == found.k1[1] && (found.k1[0] - k1).abs() < 0.03 && off < 0.5,
            "{k1}: {:?} {off}",
            found.k1
        );
    }
}

#[test]
fn a_distortion_of_parallel_cameras_is_not_taken_for_a_perspective() {
    for k1 in [-0.25, -0.15] {
        let (found, off) = Rig { k1: [k1; 2], depths: [1.0, 4.0], ..SIDE_BY_SIDE }.rectified();
        assert!(matches!(found.model, Model::Right(RowKind::AsIs | RowKind::Shift)), "{:?}", found.model);
        assert!(
            found.k1[0] == found.k1[1] && (found.k1[0] - k1).abs() < 0.015 && off < 0.3,
            "{k1}: {:?} {off}",
            found.k1
        );
    }
}

#[test]
fn lenses_that_differ_are_told_apart() {
    for (k1, turn) in [([0.0, -0.2], DVec3::ZERO), ([-0.15, 0.0], DVec3::Z * 5.0), ([-0.2, -0.05], DVec3::ZERO)] {
        let rig = Rig { k1, turns: [DVec3::ZERO, turn], depths: [1.0, 4.0], ..SIDE_BY_SIDE };
        let (found, off) = rig.rectified();
        let error = [0, 1].map(|view| (found.k1[view] - k1[view]).abs());
        assert!(error.iter().all(|&error| error < 0.02) && off < 0.5, "{k1:?}: {:?} {off}", found.k1);
    }
}

#[test]
fn lenses_of_opposite_senses_are_not_believed() {
    let rig = Rig { k1: [-0.2, 0.15], depths: [1.0, 4.0], ..SIDE_BY_SIDE };
    let found = Uncalibrated::new(&rig.matched(), [SIZE; 2], 1);
    assert!(found.as_ref().map_or(true, |found| found.k1[0] == found.k1[1]), "{found:?}");
}

#[test]
fn a_pixel_goes_there_and_back() {
    let rig = Rig { k1: [-0.15; 2], turns: [DVec3::Z * 8.0, DVec3::new(1.0, 2.0, -9.0)], ..SIDE_BY_SIDE };
    let (found, _) = rig.rectified();
    for view in [0, 1] {
        for pixel in [DVec2::ZERO, DVec2::new(700.0, 100.0), DVec2::new(333.0, 599.0)] {
            let back = found.original(view, found.rectified(view, pixel).unwrap()).unwrap();
            assert!(back.abs_diff_eq(pixel, 1e-6), "{pixel}: {back}");
        }
    }
}

#[test]
fn what_cannot_be_rectified_is_told_apart() {
    let plane = Rig { depths: [4.0, 4.0], ..Rig::turned([1.0, 3.0, 10.0]) };
    assert_eq!(plane.relation(), Relation::Plane);
    let spot = Rig { place: DVec3::ZERO, ..Rig::turned([2.0, 9.0, 4.0]) };
    assert_eq!(spot.relation(), Relation::Turned);
    // Both see a similarity.
    let roll = Rig { place: DVec3::ZERO, ..Rig::turned([0.0, 0.0, 25.0]) };
    assert_eq!(roll.relation(), Relation::Flat);
    let still = Rig { place: DVec3::ZERO, ..SIDE_BY_SIDE };
    assert_eq!(still.relation(), Relation::Still);
    let forward = Rig { place: DVec3::new(0.02, 0.01, 0.6), depths: [2.0, 6.0], ..SIDE_BY_SIDE };
    assert_eq!(forward.relation(), Relation::Forward);
    let mut random = random();
    let mut place = || DVec2::new(800.0 * random(), 600.0 * random());
    let unrelated: Vec<_> = (0..200).map(|_| Correspondence { left: place(), right: place() }).collect();
    let refused = Uncalibrated::new(&unrelated, [SIZE; 2], 1).unwrap_err();
    assert!(matches!(refused, Refusal::Relation(Evidence { relation: Relation::Unrelated, .. })), "{refused}");
    let relation = |points: &[Correspondence]| match Uncalibrated::new(points, [SIZE; 2], 1) {
        Err(Refusal::Relation(evidence)) => evidence.relation,
        other => panic!("{other:?}"),
    };
    assert_eq!(relation(&[]), Relation::Unrelated);
    // A fifth is left out of the fit.
    let few = Uncalibrated::new(&unrelated[..10], [SIZE; 2], 1).unwrap_err().to_string();
    assert!(few.contains("8 matched points do not tell"), "{few}");
    // Exact copies of one picture, which any number of matrices explain.
    let moved = |by: DVec2| -> Vec<Correspondence> {
        unrelated.iter().map(|point| Correspondence { right: point.left + by, ..*point }).collect()
    };
    assert_eq!(relation(&moved(DVec2::ZERO)), Relation::Still);
    assert_eq!(relation(&moved(DVec2::new(3.0, 40.0))), Relation::Plane);
}

#[test]
fn a_turn_to_the_side_is_one_on_the_spot_though_rows_nearly_agree() {
    let shown = |rig: Rig| without_depth(&rig.points(300, 0.35), [SIZE; 2], 1);
    for pan in [3.0, 6.0, 12.0] {
        let turned = Rig::turned([0.0, pan, 0.0]);
        let spot = Rig { place: DVec3::ZERO, ..turned };
        assert_eq!((shown(spot), spot.relation()), (Some(Relation::Turned), Relation::Turned), "{pan}");
        assert_eq!(shown(turned), None, "{pan}: a scene with depth");
        assert_eq!(shown(Rig { depths: [4.0, 4.0], ..turned }), Some(Relation::Plane), "{pan}");
    }
    let roll = Rig { place: DVec3::ZERO, ..Rig::turned([0.0, 0.0, 2.0]) };
    assert_eq!((shown(roll), shown(SIDE_BY_SIDE)), (Some(Relation::Flat), None));
}

#[test]
fn a_plane_whose_rows_agree_is_a_rectified_pair() {
    let wall = Rig { depths: [4.0, 4.0], ..SIDE_BY_SIDE };
    let (found, off) = wall.rectified();
    assert!(matches!(found.model, Model::Right(RowKind::AsIs | RowKind::Shift)) && off < 0.2, "{:?}", found.model);
}

#[test]
fn reduced_views_have_the_rectification_of_the_whole_ones() {
    let rig = Rig { turns: [DVec3::Z * 10.0, DVec3::Z * -10.0], ..SIDE_BY_SIDE };
    let points = rig.matched();
    let whole = |pixel: DVec2| pixel * 3.0 + 1.0;
    let enlarged: Vec<_> =
        points.iter().map(|point| Correspondence { left: whole(point.left), right: whole(point.right) }).collect();
    let small = Uncalibrated::new(&points, [SIZE; 2], 1).unwrap();
    let large = Uncalibrated::new(&enlarged, [Size::new(2400, 1800); 2], 3).unwrap();
    assert_eq!(small.model, large.model);
    let (a, b) = (DVec2::new(100.0, 200.0), DVec2::new(700.0, 550.0));
    let between = |found: &Uncalibrated, a, b| found.rectified(1, b).unwrap() - found.rectified(1, a).unwrap();
    let off = between(&large, whole(a), whole(b)) / 3.0 - between(&small, a, b);
    assert!(off.length() < 0.01, "{off}");
}

#[test]
fn the_same_points_give_the_same_bits() {
    let points = Rig::turned([-3.0, 4.0, 12.0]).matched();
    assert_eq!(Uncalibrated::new(&points, [SIZE; 2], 1), Uncalibrated::new(&points, [SIZE; 2], 1));
}

#[test]
fn homographies_are_those_of_the_maps() {
    let (found, _) = Rig { turns: [DVec3::Z * 10.0, DVec3::Z * -10.0], ..SIDE_BY_SIDE }.rectified();
    let maps = found.maps().unwrap();
    for (view, map) in maps.iter().enumerate() {
        let pixel = DVec2::new(150.0, 200.0);
        let at = map.source_at(150, 200).unwrap().as_dvec2() / 2048.0;
        assert!(at.abs_diff_eq(found.original(view, pixel).unwrap(), 0.05), "{at}");
        let back: DMat3 = found.homographies[view];
        assert!(frame::mapped(&back, at).unwrap().abs_diff_eq(pixel, 0.05));
    }
}
