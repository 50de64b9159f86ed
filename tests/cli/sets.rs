//! The files of an output folder are of one run.

use std::{fs, path::Path};

use assert_cmd::Command;
use predicates::str::contains;

use crate::common::{fails, folder, hsad, match_on_cpu, names, report, scene, views};
#[cfg(unix)]
use crate::interruption::Run;

const MAPS: [&str; 5] = ["confidence.png", "disparity-color.png", "disparity.pfm", "disparity.png", "report.json"];

/// A short match on the CPU.
fn short_match(folder: &Path) -> Command {
    let [left, right] = views("weak");
    let mut command = match_on_cpu(&left, &right, folder);
    command.args(["--disparities", "16", "--preset", "fast", "--force", "-q"]);
    command
}

#[test]
fn files_of_an_earlier_run_go_with_its_report_and_no_others() {
    let temporary = folder();
    let out = temporary.path();
    hsad().args(["demo", "-q", "--device", "cpu", "-o"]).arg(out).assert().success();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    // What is read stays.
    let [left, right] = ["left.png", "right.png"].map(|name| out.join(name));
    let mut command = match_on_cpu(&left, &right, out);
    command.args(["--matches", "-q"]).assert().success();
    let mut expected = MAPS.to_vec();
    expected.extend(["left.png", "matches.csv", "notes.txt", "right.png"]);
    expected.sort_unstable();
    assert_eq!(names(out), expected);
    short_match(out).assert().success();
    assert!(!out.join("matches.csv").exists());
    let files = report(out)["files"].as_array().unwrap().len();
    assert_eq!(files, MAPS.len());

    hsad().arg("features").arg(&left).args(["-q", "--device", "cpu", "-o"]).arg(out).assert().success();
    assert_eq!(names(out), ["features.csv", "keypoints.png", "left.png", "notes.txt", "report.json", "right.png"]);
}

#[test]
fn files_that_hsad_did_not_write_are_not_replaced() {
    let told = "would replace a file that no report.json beside it lists as hsad's: name another folder (-o)";
    let refused = |name: &str, command: Command, out: &Path| {
        fs::create_dir_all(out).unwrap();
        fs::write(out.join(name), "mine").unwrap();
        fails(command, 1, told);
        assert_eq!(names(out), [name]);
        assert_eq!(fs::read(out.join(name)).unwrap(), b"mine");
    };
    let temporary = folder();
    let out = |name: &str| temporary.path().join(name);
    let run = |words: &[&str], out: &Path| {
        let mut command = hsad();
        command.args(words).args(["--device", "cpu", "-o"]).arg(out);
        command
    };
    refused("left.png", run(&["demo"], &out("demo")), &out("demo"));
    refused("report.json", short_match(&out("match")), &out("match"));
    let mut deep = short_match(&out("deep"));
    deep.args(["--focal", "300", "--baseline", "0.1"]);
    refused("cloud.ply", deep, &out("deep"));
    let picture = scene("weak", "left.png");
    refused("keypoints.png", run(&["features", picture.to_str().unwrap()], &out("points")), &out("points"));

    // Nor those that a report names which another program wrote.
    let named = temporary.path().join("named");
    fs::create_dir(&named).unwrap();
    fs::write(named.join("thesis.tex"), "mine").unwrap();
    fs::write(named.join("report.json"), r#"{ "version": "0.1.0", "files": ["thesis.tex", "cloud.ply"] }"#).unwrap();
    fs::write(named.join("cloud.ply"), "").unwrap();
    short_match(&named).assert().success();
    let expected: Vec<&str> = MAPS.into_iter().chain(["thesis.tex"]).collect();
    assert_eq!(names(&named), expected);

    // A name that is not needed is free.
    fs::create_dir(out("free")).unwrap();
    fs::write(out("free").join("cloud.ply"), "mine").unwrap();
    short_match(&out("free")).assert().success();
    short_match(&out("free")).assert().success();
    assert_eq!(fs::read(out("free").join("cloud.ply")).unwrap(), b"mine");
}

#[cfg(unix)]
#[test]
fn leftovers_of_a_killed_run_are_cleared_by_the_next() {
    let temporary = folder();
    let out = temporary.path().join("out");
    fs::create_dir(&out).unwrap();
    for name in [".hsad-a1B2c3", ".hsad-mine"] {
        fs::write(out.join(name), "").unwrap();
    }
    short_match(&out).assert().success();
    assert!(!out.join(".hsad-a1B2c3").exists() && out.join(".hsad-mine").exists());
}

#[cfg(unix)]
#[test]
fn a_second_run_into_a_folder_says_so_at_once() {
    let temporary = folder();
    let out = temporary.path().join("out/new");
    let mut first = Run::start(crate::match_views::endless(temporary.path(), &out), &[]);
    first.wait_for(&out);
    let told = "another run of hsad is writing its results there: name another folder (-o), or wait for its end";
    fails(short_match(&out), 1, told);
    first.stays();
    assert!(out.exists());
    first.signal(libc::SIGINT);
    assert_eq!(first.exit_code(), Some(130));
    short_match(&out).assert().success();
    assert_eq!(names(&out), MAPS);
}

/// One of them may be told that the other one is there; none fails after its work.
#[cfg(unix)]
#[test]
fn two_runs_at_once_leave_one_set() {
    let temporary = folder();
    for round in 0..4 {
        let out = temporary.path().join(format!("{round}/new"));
        let runs = [(); 2].map(|()| {
            let out = out.clone();
            std::thread::spawn(move || short_match(&out).output().unwrap())
        });
        let ended = runs.map(|run| run.join().unwrap());
        assert!(ended.iter().any(|run| run.status.success()));
        for run in ended.iter().filter(|run| !run.status.success()) {
            assert!(String::from_utf8_lossy(&run.stderr).contains("another run of hsad"), "{run:?}");
        }
        assert_eq!(names(&out), MAPS);
    }
}

/// All files are there: a run that is interrupted while it prints its summary did its work.
#[cfg(unix)]
#[test]
fn an_interruption_after_the_work_is_none() {
    use std::{
        fs::File,
        io::{Read, Write},
        os::fd::{AsRawFd, FromRawFd},
    };
    let temporary = folder();
    let out = temporary.path().join("out");
    let mut ends = [0; 2];
    // SAFETY: the call fills both descriptors, which nothing else owns.
    let [mut reader, mut writer] = unsafe {
        assert_eq!(libc::pipe(ends.as_mut_ptr()), 0);
        ends.map(|end| File::from_raw_fd(end))
    };
    let blocking = |file: &File, flags: libc::c_int| {
        // SAFETY: the descriptor is open.
        assert_eq!(unsafe { libc::fcntl(file.as_raw_fd(), libc::F_SETFL, flags) }, 0);
    };
    // A pipe that takes no summary.
    blocking(&writer, libc::O_NONBLOCK);
    while writer.write(&[b' '; 4096]).is_ok() {}
    while writer.write(b" ").is_ok() {}
    blocking(&writer, 0);
    let [left, right] = views("weak");
    let words = ["match", "--device", "cpu", "--disparities", "16", "--preset", "fast", "--force", "-o"];
    let arguments = words.iter().map(Into::into).chain([&out, &left, &right].map(Into::<std::ffi::OsString>::into));
    let mut run = Run::printing_to(arguments, &[], writer);
    run.wait_for(&out.join("report.json"));
    run.signal(libc::SIGINT);
    assert_eq!(run.exit_code(), Some(0));
    assert_eq!(names(&out), MAPS);
    assert!(reader.read(&mut [0; 9]).is_ok());
}

/// An error that the system tells late, as a network's disk does that is full.
#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_synced_is_not_written() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    fs::write(path("sync.c"), "#include <errno.h>\nint fsync(int file) { (void)file; errno = EIO; return -1; }\n")
        .unwrap();
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-o"]).args([path("sync.so"), path("sync.c")]).assert().success();
    let out = path("out");
    short_match(&out).assert().success();
    let before = fs::read(out.join("report.json")).unwrap();
    let [left, right] = views("weak");
    let mut failing = match_on_cpu(&left, &right, &out);
    failing.args(["--disparities", "20", "--preset", "fast", "--force"]).env("LD_PRELOAD", path("sync.so"));
    failing.assert().code(1).stderr(contains("Input/output error"));
    assert_eq!(names(&out), MAPS);
    assert_eq!(fs::read(out.join("report.json")).unwrap(), before);
}
