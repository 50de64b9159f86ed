//! The memory that this process can still take.
//!
//! Allocations are not refused where a process takes more than its container or the machine has: the process is killed. So
//! the need of a task is compared with what is left before the task begins.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::error::{Error, Result};

/// Share of the memory that is left to everything that is not counted, as a divisor.
const UNCOUNTED: u64 = 16;

/// The memory that is left, and what limits it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Left {
    /// In bytes.
    pub bytes: u64,
    pub by: &'static str,
}

impl Left {
    /// The memory that is left to a task; `None` where the system does not tell.
    pub fn now() -> Option<Self> {
        let left = Self::of(Path::new("/"))?;
        Some(Self { bytes: left.bytes - left.bytes / UNCOUNTED, ..left })
    }

    /// The least of all limits, each without what is in use, from the files of Linux below `root`.
    fn of(root: &Path) -> Option<Self> {
        let read = |file: &str| fs::read_to_string(root.join(file)).ok();
        let (limits, status) = (read("proc/self/limits"), read("proc/self/status"));
        let of_process = |limit: &str, used: &str| {
            let limit = field(limits.as_deref()?, limit)?.parse::<u64>().ok()?;
            Some(limit.saturating_sub(1024 * number(status.as_deref()?, used)?))
        };
        let machine = read("proc/meminfo").and_then(|text| {
            let free = number(&text, "MemAvailable:")? + number(&text, "SwapFree:").unwrap_or(0);
            Some(1024 * free)
        });
        [
            (of_process("Max address space", "VmSize:"), "the limit of the process's address space (ulimit -v)"),
            (of_process("Max data size", "VmData:"), "the limit of the process's data (ulimit -d)"),
            (of_groups(root, &read("proc/self/cgroup").unwrap_or_default()), "the memory limit of the container"),
            (machine, "the machine"),
        ]
        .into_iter()
        .filter_map(|(bytes, by)| Some(Self { bytes: bytes?, by }))
        .min_by_key(|left| left.bytes)
    }
}

/// Refuses a task, before it begins, that needs more memory than is left.
///
/// # Errors
/// [`Error::NotEnoughMemory`].
pub(crate) fn check(needed: u64, left: Option<Left>, what: impl FnOnce() -> String, way_out: &str) -> Result<()> {
    match left {
        Some(Left { bytes, by }) if needed > bytes => {
            Err(Error::NotEnoughMemory { what: what(), needed, available: bytes, by, way_out: way_out.into() })
        }
        _ => Ok(()),
    }
}

/// What the control groups of the process, and the groups that hold them, leave, in bytes. A container may see its own
/// group at the top of the file system, whatever the group's path.
fn of_groups(root: &Path, groups: &str) -> Option<u64> {
    /// Folder, limit, use, and what of the use is given back when memory is short: in version 2 and in version 1.
    const VERSIONS: [(&str, &str, &str, [&str; 2]); 2] = [
        ("sys/fs/cgroup", "memory.max", "memory.current", ["active_file", "inactive_file"]),
        (
            "sys/fs/cgroup/memory",
            "memory.limit_in_bytes",
            "memory.usage_in_bytes",
            ["total_active_file", "total_inactive_file"],
        ),
    ];
    let left = |folder: &Path, (_, limit, used, cached): (&str, &str, &str, [&str; 2])| {
        let read = |file: &str| fs::read_to_string(folder.join(file)).ok();
        let limit = read(limit)?.trim().parse::<u64>().ok()?;
        let used = read(used)?.trim().parse::<u64>().ok()?;
        let stat = read("memory.stat").unwrap_or_default();
        let cached: u64 = cached.into_iter().filter_map(|key| number(&stat, key)).sum();
        Some(limit.saturating_sub(used.saturating_sub(cached)))
    };
    let lines = groups.lines().filter_map(|line| line.splitn(3, ':').collect::<Vec<_>>().try_into().ok());
    let found = lines.filter_map(|[_, controllers, path]: [&str; 3]| {
        let version = match controllers {
            "" => VERSIONS[0],
            _ if controllers.split(',').any(|name| name == "memory") => VERSIONS[1],
            _ => return None,
        };
        let top = root.join(version.0);
        let group: PathBuf = top.join(path.trim_start_matches('/'));
        group.ancestors().take_while(|folder| folder.starts_with(&top)).filter_map(|folder| left(folder, version)).min()
    });
    found.min()
}

/// The first word after `key` at the beginning of a line.
fn field<'t>(text: &'t str, key: &str) -> Option<&'t str> {
    text.lines().find_map(|line| line.strip_prefix(key)?.split_whitespace().next())
}

/// The number after the word `key` at the beginning of a line.
fn number(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find(|line| line.split_whitespace().next() == Some(key))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file system of the given files; the folder stays as long as the guard.
    fn files(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    const LIMITS: &str = "Limit                     Soft Limit           Hard Limit           Units     \n\
                          Max data size             unlimited            unlimited            bytes     \n\
                          Max address space         5000000              unlimited            bytes     \n";

    #[test]
    fn the_least_limit_counts() {
        let status = ("proc/self/status", "Name:\thsad\nVmSize:\t    1000 kB\nVmData:\t     100 kB\n");
        let memory =
            ("proc/meminfo", "MemTotal:       9000 kB\nMemAvailable:       4000 kB\nSwapFree:        1000 kB\n");
        let limits = ("proc/self/limits", LIMITS);
        let left = |which: &[(&str, &str)]| Left::of(files(which).path());
        assert_eq!(left(&[]), None);
        assert_eq!(left(&[status, memory]), Some(Left { bytes: 5000 * 1024, by: "the machine" }));
        let of_process = left(&[status, memory, limits]).unwrap();
        assert!(of_process.bytes == 5_000_000 - 1000 * 1024 && of_process.by.contains("ulimit -v"), "{of_process:?}");
    }

    #[test]
    fn groups_of_both_versions_and_the_groups_around_them_count() {
        let two = [
            ("proc/self/cgroup", "0::/a/b\n"),
            ("sys/fs/cgroup/a/b/memory.max", "max\n"),
            ("sys/fs/cgroup/a/b/memory.current", "50\n"),
            ("sys/fs/cgroup/a/memory.max", "9000\n"),
            ("sys/fs/cgroup/a/memory.current", "3000\n"),
            ("sys/fs/cgroup/a/memory.stat", "anon 1000\nactive_file 200\ninactive_file 800\n"),
        ];
        let left = |which: &[(&str, &str)]| Left::of(files(which).path()).map(|left| left.bytes);
        assert_eq!(left(&two), Some(7000));
        // The path is that of the host, and the group is mounted at the top.
        let one = [
            ("proc/self/cgroup", "5:cpu:/x\n4:memory:/docker/123\n0::/\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "8000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "8500\n"),
            ("sys/fs/cgroup/memory/memory.stat", "cache 3000\ntotal_inactive_file 2500\n"),
        ];
        assert_eq!(left(&one), Some(2000));
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_figures() {
        let left = Some(Left { bytes: 300 << 20, by: "the machine" });
        let what = || "matching".into();
        assert!(check(300 << 20, left, what, "").is_ok() && check(u64::MAX, None, what, "").is_ok());
        let text = check((300 << 20) + 1, left, what, "scale it down").unwrap_err().to_string();
        assert_eq!(text, "matching needs 301 MiB of memory, and the machine leaves 300 MiB: scale it down");
    }
}
