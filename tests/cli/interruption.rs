//! Runs of the program that signals interrupt, whatever the parent of the tests does with these signals.

use std::{
    ffi::OsStr,
    io,
    os::unix::process::CommandExt,
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

/// The signals that the program ends by.
const SIGNALS: [libc::c_int; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

/// No wait takes longer, also on a loaded machine.
const LIMIT: Duration = Duration::from_secs(60);

/// A run on its way. It does not outlive its test.
pub struct Run(Child);

impl Run {
    /// Starts the program with `ignored` signals ignored and the others as they are by default. A shell ignores SIGINT for
    /// what it runs in the background, and a process hands that on to all that it starts.
    pub fn start(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>, ignored: &'static [libc::c_int]) -> Self {
        Self::printing_to(arguments, ignored, Stdio::inherit())
    }

    /// As [`Self::start`], with the summary on `stdout`.
    pub fn printing_to(
        arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
        ignored: &'static [libc::c_int],
        stdout: impl Into<Stdio>,
    ) -> Self {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("hsad"));
        command.args(arguments).env_remove("RUST_LOG").stdout(stdout);
        let dispositions = move || {
            for signal in SIGNALS {
                let action = if ignored.contains(&signal) { libc::SIG_IGN } else { libc::SIG_DFL };
                // SAFETY: neither action runs any code.
                if unsafe { libc::signal(signal, action) } == libc::SIG_ERR {
                    return Err(io::Error::last_os_error());
                }
            }
            Ok(())
        };
        // SAFETY: between fork and exec the closure calls `signal` alone, which is safe there, and allocates nothing.
        unsafe { command.pre_exec(dispositions) };
        Self(command.spawn().expect("the program starts"))
    }

    /// Waits until the run has made `path`, and a moment more, so that its work has begun.
    #[track_caller]
    pub fn wait_for(&mut self, path: &Path) {
        let start = Instant::now();
        while !path.exists() {
            assert!(self.is_running(), "ended before it was interrupted");
            assert!(start.elapsed() < LIMIT, "{} has not appeared", path.display());
            thread::sleep(Duration::from_millis(5));
        }
        self.stays();
    }

    /// Finds the run still on its way after a moment.
    #[track_caller]
    pub fn stays(&mut self) {
        thread::sleep(Duration::from_millis(200));
        assert!(self.is_running(), "ended by itself, or by a signal that is ignored");
    }

    /// Sends a signal.
    #[track_caller]
    pub fn signal(&self, signal: libc::c_int) {
        let id = self.0.id().cast_signed();
        // SAFETY: it is the id of a child that was not waited for.
        assert_eq!(unsafe { libc::kill(id, signal) }, 0, "{}", io::Error::last_os_error());
    }

    /// The code that the run exits with, soon.
    #[track_caller]
    pub fn exit_code(mut self) -> Option<i32> {
        let start = Instant::now();
        while start.elapsed() < LIMIT {
            if let Some(status) = self.0.try_wait().expect("a child") {
                return status.code();
            }
            thread::sleep(Duration::from_millis(5));
        }
        panic!("the signal did not end the run");
    }

    fn is_running(&mut self) -> bool {
        self.0.try_wait().expect("a child").is_none()
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        // It has ended already, unless the test failed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
