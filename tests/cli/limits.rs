//! Runs of the program where the system limits memory or threads.

use std::{
    fs,
    io::{self, Read},
    os::{
        fd::{FromRawFd, OwnedFd},
        unix::{fs::PermissionsExt, process::CommandExt},
    },
    path::{Path, PathBuf},
    process::{Command, Output},
    ptr, thread,
};

use tempfile::TempDir;

use crate::common::{folder, grey_png, names, noise, report, views};

/// The user without any rights; `root` may start as many threads as it likes.
const NOBODY: libc::uid_t = 65_534;

/// A program that a user without rights can start, in a folder that this user can write to.
struct Installed {
    folder: TempDir,
    program: PathBuf,
}

impl Installed {
    fn new() -> Self {
        let folder = folder();
        let allow = |path: &Path| fs::set_permissions(path, fs::Permissions::from_mode(0o777)).unwrap();
        allow(folder.path());
        let program = folder.path().join("hsad");
        fs::copy(assert_cmd::cargo::cargo_bin!("hsad"), &program).unwrap();
        allow(&program);
        for view in views("planes") {
            fs::copy(&view, folder.path().join(view.file_name().unwrap())).unwrap();
        }
        Self { folder, program }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `hsad match` of the shipped pair on the CPU, with these arguments, into the folder `name`.
    fn matching(&self, name: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.arg("match").args(["left.png", "right.png"].map(|view| self.path(view)));
        command.arg("-o").arg(self.path(name)).args(["--device", "cpu"]).args(arguments).env_remove("RUST_LOG");
        command
    }
}

/// Starts the program with a limit of a resource, for a user whom the limit binds.
fn limited(mut command: Command, resource: libc::__rlimit_resource_t, limit: u64) -> Command {
    let limit_both = move || {
        let limit = libc::rlimit { rlim_cur: limit, rlim_max: limit };
        // SAFETY: `setuid` and `setrlimit` only read what they are given.
        let done = unsafe {
            // The limit comes last: a user with more processes than allowed cannot start another program.
            (libc::geteuid() != 0 || resource != libc::RLIMIT_NPROC || libc::setuid(NOBODY) == 0)
                && libc::setrlimit(resource, &limit) == 0
        };
        if done { Ok(()) } else { Err(io::Error::last_os_error()) }
    };
    // SAFETY: between fork and exec the closure makes system calls alone, and allocates nothing.
    unsafe { command.pre_exec(limit_both) };
    command
}

/// A run without any thread but its own.
fn alone(command: Command) -> Command {
    limited(command, libc::RLIMIT_NPROC, 1)
}

fn succeeded(output: &Output) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {stderr}", output.status);
    assert_eq!(stderr, "");
}

#[test]
fn one_thread_does_the_work_where_no_other_is_allowed() {
    let installed = Installed::new();
    for preset in ["fast", "balanced"] {
        let run = |name: &str, limit: fn(Command) -> Command| {
            succeeded(&limit(installed.matching(name, &["--preset", preset])).output().unwrap());
            fs::read(installed.path(name).join("disparity.pfm")).unwrap()
        };
        assert_eq!(run("alone", alone), run("free", |command| command), "{preset}");
    }
}

/// Too few threads for the shared work, which the program's own thread does then, and enough for a second pair, which must not wait for it.
#[test]
fn a_batch_ends_where_a_few_threads_are_allowed() {
    let installed = Installed::new();
    let list = installed.path("pairs.csv");
    fs::write(&list, "left,right,name\nleft.png,right.png,a\nleft.png,right.png,b\n").unwrap();
    let mut command = Command::new(&installed.program);
    command.arg("batch").arg(list).arg("-o").arg(installed.path("out")).env_remove("RUST_LOG");
    command.args(["--device", "cpu", "--preset", "fast", "--disparities", "64", "--jobs", "2", "-q"]);
    succeeded(&limited(command, libc::RLIMIT_NPROC, 3).output().unwrap());
    assert_eq!(names(&installed.path("out")), ["a", "b", "batch.json", "report.jsonl"]);
}

#[test]
fn no_thread_for_the_progress_is_no_failure() {
    let installed = Installed::new();
    for (quiet, expected) in [(&[][..], "matching every pixel"), (&["-q"], "")] {
        let (mut terminal, program_side) = terminal();
        let mut command = installed.matching("out", quiet);
        command.env("TERM", "xterm").stderr(program_side);
        let reader = thread::spawn(move || {
            // The end of a terminal is an error.
            let mut text = Vec::new();
            let _ = terminal.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        let output = alone(command).output().unwrap();
        let text = reader.join().unwrap();
        assert!(output.status.success(), "{}: {text}", output.status);
        assert!(text.contains(expected) && (!quiet.is_empty() || !text.contains("panicked")), "{text}");
        assert!(quiet.is_empty() || text.is_empty(), "{text}");
    }
}

/// Both sides of a terminal; the program's side closes with the command that holds it.
fn terminal() -> (fs::File, OwnedFd) {
    let (mut own, mut other) = (-1, -1);
    // SAFETY: the descriptors are written to the two places, and nothing else is passed.
    let opened = unsafe { libc::openpty(&mut own, &mut other, ptr::null_mut(), ptr::null(), ptr::null()) };
    assert_eq!(opened, 0, "{}", io::Error::last_os_error());
    // SAFETY: both descriptors are new and owned by nothing else.
    unsafe { (fs::File::from_raw_fd(own), OwnedFd::from_raw_fd(other)) }
}

/// What a refused run says, after a check that it left nothing.
fn refused(command: Command, folder: &Path) -> String {
    let mut command = command;
    let output = command.env("RAYON_NUM_THREADS", "1").output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{:?}: {stderr}", output.status);
    assert!(stderr.starts_with("error: ") && stderr.lines().count() == 1, "{stderr}");
    assert!(!folder.exists(), "{:?}", names(folder));
    stderr
}

#[test]
fn a_task_that_memory_does_not_hold_is_refused_beforehand() {
    let folder = folder();
    let [left, right] = ["left.png", "right.png"].map(|name| folder.path().join(name));
    let scene = noise(6400, 40, 3);
    grey_png(&left, &scene);
    grey_png(&right, &scene);
    let out = folder.path().join("out");
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("hsad"));
    command.arg("match").args([&left, &right]).arg("-o").arg(&out);
    // The costs of a single row take 41 MB, and those of its paths several times as much.
    command.args(["--device", "cpu", "--disparities", "6400", "--whole-range"]);
    let text = refused(limited(command, libc::RLIMIT_AS, 400 << 20), &out);
    for part in ["6400x40 pixels over 6400 disparities", "MiB", "ulimit -v", "search fewer disparities"] {
        assert!(text.contains(part), "'{part}' is not in: {text}");
    }
}

#[test]
fn memory_that_the_system_refuses_is_an_error_that_leaves_nothing() {
    let folder = folder();
    let view = folder.path().join("view.png");
    grey_png(&view, &hsad::image::Plane::filled((8000, 6000), 7));
    let out = folder.path().join("a/b");
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("hsad"));
    command.arg("match").args([&view, &view]).arg("-o").arg(&out).args(["--device", "cpu"]);
    command.env("RAYON_NUM_THREADS", "2");
    // Enough to read the pictures.
    let text = refused(limited(command, libc::RLIMIT_AS, 820 << 20), &out);
    assert!(text.contains("refuses") && text.contains("bytes of memory"), "{text}");
    assert!(!folder.path().join("a").exists());
}

#[test]
fn a_limit_of_file_sizes_is_an_error_that_leaves_nothing() {
    let installed = Installed::new();
    let command = installed.matching("out", &["-q"]);
    let text = refused(limited(command, libc::RLIMIT_FSIZE, 100 << 10), &installed.path("out"));
    assert!(text.contains("disparity.pfm"), "{text}");
}

#[test]
fn little_memory_gives_the_same_map() {
    let installed = Installed::new();
    // In one piece the costs along all paths would take 265 MB.
    let arguments = ["--paths", "8", "--disparities", "340"];
    succeeded(&installed.matching("free", &arguments).output().unwrap());
    let mut command = installed.matching("little", &arguments);
    command.env("RAYON_NUM_THREADS", "1");
    succeeded(&limited(command, libc::RLIMIT_AS, 176 << 20).output().unwrap());
    let map = |name: &str| fs::read(installed.path(name).join("disparity.pfm")).unwrap();
    assert_eq!(map("little"), map("free"));
    assert_eq!(report(&installed.path("little"))["device"]["backend"], "none");
}
