//! What happens when the program is interrupted: nothing half done is left, and what is done stays.

use std::{
    fs,
    path::PathBuf,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicI32, Ordering},
    },
};

use hsad::io::atomic;

/// Folders that were created for a run, the deepest first. An interruption waits while the lock is held.
static CREATED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The exit code of an interruption: first that which a shell reports for a program ended by SIGINT.
static EXIT_CODE: AtomicI32 = AtomicI32::new(130);

/// Whether a set of files is taking its place, which no thread may interrupt, and which ends soon.
static REPLACING: AtomicBool = AtomicBool::new(false);

/// Notes folders that are removed by an interruption, if they are empty then.
pub fn created(folders: &[PathBuf]) {
    lock().extend(folders.iter().cloned());
}

/// Runs `replace`, and keeps interruptions waiting until it is done. Where it succeeds and `code` is given, the run has done all of its
/// work, and ends with `code` even if it is interrupted.
///
/// # Errors
/// Those of `replace`.
pub fn uninterrupted<E>(code: Option<i32>, replace: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
    let _waiting = lock();
    REPLACING.store(true, Ordering::SeqCst);
    let replaced = replace();
    if let (Ok(()), Some(code)) = (&replaced, code) {
        EXIT_CODE.store(code, Ordering::SeqCst);
    }
    REPLACING.store(false, Ordering::SeqCst);
    replaced
}

fn lock() -> MutexGuard<'static, Vec<PathBuf>> {
    CREATED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Installs the handler that removes temporary files and empty folders when the process is interrupted by Ctrl-C,
/// SIGTERM or SIGHUP. The handler runs in a thread of its own, and the process ends without dropping anything. Where no
/// thread can be spawned, the handler runs in the thread that is interrupted.
///
/// # Errors
/// If the system refuses the handler.
pub fn clean_up_when_interrupted() -> anyhow::Result<()> {
    #[cfg(unix)]
    // SAFETY: no handler is installed. A write beyond a limit of file sizes is an error, as others are, and ends no process.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
    let ignored = ignored_signals();
    let handled = ctrlc::set_handler(|| {
        let created = lock();
        atomic::abandon();
        remove_empty(&created);
        exit_at_once(EXIT_CODE.load(Ordering::SeqCst));
    });
    match handled {
        Err(ctrlc::Error::System(_)) => without_thread(),
        handled => handled?,
    }
    keep_ignoring(&ignored);
    Ok(())
}

/// Ends the process and removes what [`clean_up_when_interrupted`] does, without waiting for any thread and without taking
/// memory. A list that is in use stays as it is.
pub fn abandon_at_once(code: i32) -> ! {
    atomic::try_abandon();
    if let Ok(created) = CREATED.try_lock() {
        remove_empty(&created);
    }
    exit_at_once(code)
}

/// Exits without the destructors of drivers: on an interrupt other threads still use what they would destroy, and at the end
/// of the program Mesa's now and then run code that is unloaded already, which ends in a segmentation fault.
pub fn exit_at_once(code: i32) -> ! {
    #[cfg(unix)]
    // SAFETY: `_exit` only ends the process.
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// The signals that interrupt.
#[cfg(unix)]
const SIGNALS: [libc::c_int; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

/// Handles interruptions in the thread that they interrupt.
#[cfg(unix)]
fn without_thread() {
    extern "C" fn handle(_: libc::c_int) {
        // The thread that is interrupted is the one that moves the files.
        if !REPLACING.load(Ordering::SeqCst) {
            abandon_at_once(EXIT_CODE.load(Ordering::SeqCst))
        }
    }
    for signal in SIGNALS {
        // SAFETY: the handler takes no memory and no lock that is held; it returns only to what it interrupts.
        unsafe {
            libc::signal(signal, handle as extern "C" fn(libc::c_int) as libc::sighandler_t);
        }
    }
}

#[cfg(not(unix))]
fn without_thread() {}

/// The signals that the parent process asked to ignore: nohup does, and a shell does for a background job.
#[cfg(unix)]
fn ignored_signals() -> Vec<libc::c_int> {
    let is_ignored = |&signal: &libc::c_int| {
        // SAFETY: without a new action the call only queries, and a zeroed action is valid to be overwritten.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            libc::sigaction(signal, std::ptr::null(), &mut action) == 0 && action.sa_sigaction == libc::SIG_IGN
        }
    };
    SIGNALS.into_iter().filter(is_ignored).collect()
}

#[cfg(unix)]
fn keep_ignoring(signals: &[libc::c_int]) {
    for &signal in signals {
        // SAFETY: ignoring a signal runs no code.
        unsafe {
            libc::signal(signal, libc::SIG_IGN);
        }
    }
}

#[cfg(not(unix))]
fn ignored_signals() {}

#[cfg(not(unix))]
fn keep_ignoring(_: &()) {}

/// Removes the folders that are empty; the system refuses to remove the others, so results are safe.
pub fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        let _ = fs::remove_dir(folder);
    }
}
