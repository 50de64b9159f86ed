//! Both views in one file: MPO, side by side, above each other.

use std::{fs, path::Path};

use assert_cmd::Command;
use hsad::{
    image::Size,
    io::{Picture, load, png},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};

use crate::common::{fails, folder, hsad, match_on_cpu, names, report, scene, views};

/// `hsad match FILE -o FOLDER` on the CPU.
fn match_one(file: &Path, folder: &Path) -> Command {
    let mut command = hsad();
    command.arg("match").arg(file).arg("-o").arg(folder).args(["--device", "cpu", "--disparities", "72"]);
    command
}

fn write(path: &Path, picture: &Picture) {
    let mut bytes = Vec::new();
    png::write_rgba8(&mut bytes, picture).unwrap();
    fs::write(path, bytes).unwrap();
}

fn jpeg(picture: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95);
    image::load_from_memory(&fs::read(picture).unwrap()).unwrap().to_rgb8().write_with_encoder(encoder).unwrap();
    bytes
}

/// A multi-picture file of JPEGs, as cameras with two lenses write.
fn mpo(pictures: [&[u8]; 2]) -> Vec<u8> {
    let mut index = b"MPF\0MM\0*".to_vec();
    index.extend([0, 0, 0, 8, 0, 1]);
    index.extend([0xb0, 2, 0, 7, 0, 0, 0, 32, 0, 0, 0, 26, 0, 0, 0, 0]);
    let first = pictures[0].len() + 4 + index.len() + 32;
    // The second picture, from the index on, which begins behind FF D8, FF E2, the length and 'MPF'.
    for (size, offset) in [(first, 0), (pictures[1].len(), first - 10)] {
        index.extend([0x20, 2, 0, 2]);
        index.extend((size as u32).to_be_bytes());
        index.extend((offset as u32).to_be_bytes());
        index.extend([0; 4]);
    }
    let length = (index.len() as u16 + 2).to_be_bytes();
    [&[0xff, 0xd8, 0xff, 0xe2][..], &length, &index, &pictures[0][2..], pictures[1]].concat()
}

#[test]
fn an_mpo_has_both_views() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let jpegs = views("planes").map(|view| jpeg(&view));
    let [left, right] = ["left.jpg", "right.jpg"].map(path);
    fs::write(&left, &jpegs[0]).unwrap();
    fs::write(&right, &jpegs[1]).unwrap();
    fs::write(path("both.mpo"), mpo([&jpegs[0], &jpegs[1]])).unwrap();
    match_on_cpu(&left, &right, &path("two")).args(["--disparities", "72"]).assert().success();
    match_one(&path("both.mpo"), &path("one")).assert().success().stderr("");
    let map = |folder: &str| fs::read(path(folder).join("disparity.pfm")).unwrap();
    assert!(map("one") == map("two"));
    assert_eq!(report(&path("one"))["right"], path("both.mpo").to_str().unwrap());

    // Halves of one of its pictures are no views.
    let mut halved = match_one(&path("both.mpo"), &path("none"));
    halved.args(["--side-by-side", "left-right"]);
    fails(halved, 1, "it is an MPO with a picture per view, not one with both: leave the order of the views out");

    // Given twice it is its first picture twice.
    let told = contains("a file with both views is named once");
    match_on_cpu(&path("both.mpo"), &path("both.mpo"), &path("twice")).assert().code(4).stderr(told);

    let whole = fs::read(path("both.mpo")).unwrap();
    fs::write(path("cut.mpo"), &whole[..whole.len() - 9]).unwrap();
    fails(match_one(&path("cut.mpo"), &path("none")), 1, "the file is cut off");
    let small = folder();
    let narrow = small.path().join("narrow.png");
    let view = load::load(&left).unwrap();
    write(&narrow, &Picture::from_fn((200, 255), |x, y| view.get(x, y)));
    fs::write(path("unequal.mpo"), mpo([&jpegs[0], &jpeg(&narrow)])).unwrap();
    fails(match_one(&path("unequal.mpo"), &path("none")), 1, "its pictures are 340x255 and 200x255");
    assert!(!path("none").exists());
}

#[test]
fn halves_of_a_picture_are_views() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let [left, right] = views("planes");
    match_on_cpu(&left, &right, &path("two")).args(["--disparities", "72"]).assert().success();
    let expected = fs::read(path("two").join("disparity.pfm")).unwrap();
    let [left, right] = [left, right].map(|view| load::load(&view).unwrap());
    let Size { width, height } = left.size();
    let beside = |[a, b]: [&Picture; 2]| {
        // A column between them, which is in neither.
        Picture::from_fn((2 * width + 1, height), |x, y| match x {
            x if x < width => a.get(x, y),
            x if x > width => b.get(x - width - 1, y),
            _ => [255; 4],
        })
    };
    let above = |[a, b]: [&Picture; 2]| {
        Picture::from_fn((width, 2 * height), |x, y| if y < height { a.get(x, y) } else { b.get(x, y - height) })
    };
    for (picture, option, order) in [
        (beside([&left, &right]), "--side-by-side", "left-right"),
        (beside([&right, &left]), "--side-by-side", "right-left"),
        (above([&left, &right]), "--top-bottom", "left-right"),
        (above([&right, &left]), "--top-bottom", "right-left"),
    ] {
        write(&path("both.png"), &picture);
        let out = path(&format!("{option}-{order}"));
        match_one(&path("both.png"), &out).args([option, order]).assert().success().stderr("");
        assert!(fs::read(out.join("disparity.pfm")).unwrap() == expected, "{option} {order}");
        assert_eq!(report(&out)["width"], width);
    }
    let mut command = hsad();
    command.arg("rectify").arg(path("both.png")).args(["--top-bottom", "right-left", "--device", "cpu", "-o"]);
    command.arg(path("rectified")).assert().success();
    assert!(names(&path("rectified")).contains(&"right.png".into()));
}

/// A JPEG with a stereoscopic descriptor of these flags and this layout.
fn jps(picture: &Path, flags: u8, layout: u8) -> Vec<u8> {
    let jpeg = jpeg(picture);
    let segment = [&[0xff, 0xe3, 0, 16][..], b"_JPSJPS_", &[0, 4, 0, flags, layout, 1]].concat();
    [&jpeg[..2], &segment, &jpeg[2..]].concat()
}

#[test]
fn a_jps_tells_where_its_views_lie() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let [left, right] = views("planes").map(|view| load::load(&view).unwrap());
    let beside = Picture::from_fn((680, 255), |x, y| if x < 340 { right.get(x, y) } else { left.get(x - 340, y) });
    write(&path("both.png"), &beside);
    // The right view lies on the left; squeezed, too, as the third file says.
    fs::write(path("plain.jpg"), jpeg(&path("both.png"))).unwrap();
    for (name, flags, layout) in [("right.jps", 0, 2), ("half.jps", 2, 2), ("rows.jps", 0, 1)] {
        fs::write(path(name), jps(&path("both.png"), flags, layout)).unwrap();
    }
    let map = |name: &str| fs::read(path(name).join("disparity.pfm")).unwrap();
    match_one(&path("plain.jpg"), &path("1")).args(["--side-by-side", "right-left"]).assert().success().stderr("");
    match_one(&path("right.jps"), &path("2")).assert().success().stderr("");
    let told = contains("the views were squeezed to half their width: disparities are those of the squeezed pictures");
    match_one(&path("half.jps"), &path("3")).assert().success().stderr(told);
    assert!(map("1") == map("2") && map("2") == map("3"));
    fails(match_one(&path("rows.jps"), &path("4")), 1, "it is a JPS with interleaved rows");
    // An order on the command line holds, and is doubted where the file tells another one.
    let ordered = |name: &str, order: &str, out: &str| {
        let mut command = match_one(&path(name), &path(out));
        command.args(["--side-by-side", order]).assert()
    };
    ordered("right.jps", "right-left", "5").success().stderr("");
    let told = "the left view was taken to lie on the left (--side-by-side, --top-bottom), but by its descriptor it is a JPS whose left view lies \
                on the right";
    ordered("right.jps", "left-right", "6").stderr(contains(told));
    let told =
        "lie on the right (--side-by-side, --top-bottom), but by its descriptor it is a JPS with interleaved rows";
    ordered("rows.jps", "right-left", "7").success().stderr(contains(told));

    let points = |args: &[&str]| {
        let mut command = hsad();
        command.arg("features").arg(path("right.jps")).args(["-q", "--device", "cpu"]).args(args);
        String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap()
    };
    let (alone, told, named) = (points(&[]), points(&["--both-views"]), points(&["--side-by-side", "right-left"]));
    assert!(alone.starts_with("x,y,scale") && told.starts_with("x1,y1,scale1") && told == named);
    assert!(told.lines().filter(|line| line.ends_with(",1")).count() > 100);
    let mut command = hsad();
    command.arg("features").arg(path("plain.jpg")).args(["--both-views", "--device", "cpu"]);
    fails(command, 1, "no word on where its views lie as a JPS may have");
}

#[test]
fn one_picture_alone_is_no_pair() {
    let temporary = folder();
    let out = temporary.path().join("out");
    let left = scene("planes", "left.png");
    fails(
        match_one(&left, &out),
        1,
        "name the right view, too, or tell where both views lie in it (--side-by-side, --top-bottom)",
    );
    let column = temporary.path().join("column.png");
    write(&column, &Picture::filled((1, 90), [9; 4]));
    let mut command = match_one(&column, &out);
    command.args(["--side-by-side", "left-right"]);
    fails(command, 1, "too small to hold two views");
    for args in [&["--side-by-side", "left"][..], &["--side-by-side", "left-right", "--top-bottom", "left-right"]] {
        match_one(&left, &out).args(args).assert().code(2).stderr(contains("error: ").and(contains("--side-by-side")));
    }
    assert!(!out.exists());
}
