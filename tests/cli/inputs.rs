//! Files that are not what they claim: bombs, devices without an end, pipes without a writer.

use std::{
    fs,
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Command, Stdio},
};

use image::ImageEncoder;

use crate::common::{folder, hsad, names, scene, views};

/// `hsad match` with an address space of 300 MiB; its exit code and what it says.
fn within_300_mib(left: &Path, right: &Path, out: &Path) -> (Option<i32>, String) {
    use std::os::unix::process::CommandExt;
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("hsad"));
    command.arg("match").args([left, right]).arg("-o").arg(out).args(["--device", "cpu", "--preset", "fast", "-q"]);
    command.args(["--disparities", "64"]).env_remove("RUST_LOG").env("RAYON_NUM_THREADS", "1");
    let limit = || {
        let limit = libc::rlimit { rlim_cur: 300 << 20, rlim_max: 300 << 20 };
        // SAFETY: `setrlimit` only reads what it is given.
        if unsafe { libc::setrlimit(libc::RLIMIT_AS, &limit) } == 0 {
            Ok(())
        } else {
            Err(std::io::Error::last_os_error())
        }
    };
    // SAFETY: between fork and exec the closure makes one system call, and allocates nothing.
    unsafe { command.pre_exec(limit) };
    let output = command.output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_small_file_takes_little_memory_whatever_it_claims() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let [left, right] = views("planes");

    // A colour profile of 600 MB in half a megabyte.
    let luma = image::load_from_memory(&fs::read(&left).unwrap()).unwrap().into_luma8();
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    encoder.set_icc_profile(vec![0; 600 << 20]).unwrap();
    encoder.write_image(luma.as_raw(), luma.width(), luma.height(), image::ExtendedColorType::L8).unwrap();
    assert!(bytes.len() < 1 << 20);
    fs::write(path("profile.png"), bytes).unwrap();
    assert_eq!(within_300_mib(&path("profile.png"), &right, &path("profile")), (Some(0), String::new()));

    // 128 megapixels in some hundred bytes.
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpeg).encode_image(&image::RgbImage::new(64, 64)).unwrap();
    let frame = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0x1f, 0x40, 0x3e, 0x80]);
    fs::write(path("claim.jpg"), jpeg).unwrap();
    let (code, told) = within_300_mib(&path("claim.jpg"), &right, &path("out"));
    assert!(code == Some(1) && told.contains("its header claims 16000x8000 pixels"), "{told}");

    // Pixels that are really there: refused before they are decoded.
    let mut large = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut large);
    encoder.write_image(&vec![7; 10_000 * 9_000], 10_000, 9_000, image::ExtendedColorType::L8).unwrap();
    fs::write(path("large.png"), large).unwrap();
    let (code, told) = within_300_mib(&path("large.png"), &right, &path("out"));
    assert!(code == Some(1) && told.contains("large.png (10000x9000 pixels) needs"), "{told}");
    assert!(told.contains("(ulimit -v) leaves") && told.contains("scale the picture down"), "{told}");
    assert!(!path("out").exists());

    // What has no end is not read to it.
    let (code, told) = within_300_mib(Path::new("/dev/zero"), &right, &path("out"));
    assert!(code == Some(1) && told.contains("/dev/zero: not a picture"), "{told}");
    assert_eq!(names(temporary.path()), ["claim.jpg", "large.png", "profile", "profile.png"]);
}

#[test]
fn maps_and_figures_without_an_end_are_refused() {
    let planes = scene("planes", "left.png");
    let mut command = hsad();
    command.args(["eval", "dense"]).arg(planes.parent().unwrap()).args(["--disparity", "x=/dev/zero", "--given-only"]);
    command.assert().code(1).stderr(predicates::str::contains("/dev/zero: neither a PNG nor a PFM"));
    // Nor are they where results are kept, which depend on them.
    let temporary = folder();
    command.arg("-o").arg(temporary.path().join("out"));
    command.assert().code(1).stderr(predicates::str::contains("/dev/zero: neither a PNG nor a PFM"));
}

#[test]
fn a_pipe_that_nobody_writes_is_told_unless_quiet() {
    let temporary = folder();
    let pipe = temporary.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let waiting = |options: &[&str]| {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("hsad"));
        command.arg("features").arg(&pipe).args(["--device", "cpu"]).args(options).env_remove("RUST_LOG");
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let write = || {
        let mut writer = fs::OpenOptions::new().write(true).open(&pipe).unwrap();
        writer.write_all(&fs::read(scene("weak", "left.png")).unwrap()).unwrap();
    };
    let mut run = waiting(&[]);
    let mut told = String::new();
    BufReader::new(run.stderr.take().unwrap()).read_line(&mut told).unwrap();
    assert_eq!(told, format!("warning: {} is a pipe, and nobody writes to it yet: waiting\n", pipe.display()));
    write();
    let output = run.wait_with_output().unwrap();
    assert!(output.status.success() && output.stdout.starts_with(b"x,y,scale"));

    let run = waiting(&["-q"]);
    // More than the time after which it would be told.
    std::thread::sleep(std::time::Duration::from_secs(2));
    write();
    let output = run.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
