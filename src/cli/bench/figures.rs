//! The figures of a case, as a table and as JSON.

use std::time::Duration;

use hsad::gpu::{DispatchSize, Rates};
use serde_json::{Value, json};

use super::{case::Case, earlier::Earlier};

/// What was measured.
pub struct Figures {
    pub case: Case,
    /// From nothing to the first map, with the compilation of kernels.
    pub cold: Duration,
    /// Times of the other runs, in increasing order.
    pub warm: Vec<Duration>,
    /// The kernels in the order of execution.
    pub dispatches: Vec<DispatchSize>,
    /// Their times, each at its fastest.
    pub kernels: Option<Vec<(&'static str, Duration)>>,
    /// Bytes of the matcher's buffers and textures.
    pub memory: u64,
}

/// All dispatches of a kernel.
struct Sum {
    kernel: &'static str,
    dispatches: usize,
    /// Threads of the dispatch with the fewest.
    threads: Option<u64>,
    bytes: u64,
    operations: Option<u64>,
    /// Milliseconds, where they are known.
    time: Option<f64>,
}

impl Sum {
    /// Share of the device's rate of memory, 0 to 1 and more where caches hold what is read.
    fn share_of_copies(&self, rates: &Rates) -> Option<f64> {
        self.time.map(|time| self.bytes as f64 / (time / 1e3) / rates.copied)
    }

    /// Share of the device's rate of integers, where operations are counted.
    fn share_of_integers(&self, rates: &Rates) -> Option<f64> {
        self.time.zip(self.operations).map(|(time, count)| count as f64 / (time / 1e3) / rates.operations)
    }
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

impl Figures {
    fn median(&self) -> f64 {
        milliseconds(self.warm[self.warm.len() / 2])
    }

    /// Millions of pixels times disparities per second.
    fn rate(&self) -> f64 {
        let Case { size, range, .. } = self.case;
        size.pixels() as f64 * f64::from(range.count) / 1e3 / self.median()
    }

    /// The kernels in the order of first execution.
    fn sums(&self) -> Vec<Sum> {
        let mut sums: Vec<Sum> = Vec::new();
        for (number, &DispatchSize { kernel, threads, bytes, operations }) in self.dispatches.iter().enumerate() {
            let time = self.kernels.as_ref().and_then(|kernels| kernels.get(number));
            let time = time.map(|&(_, time)| milliseconds(time));
            match sums.iter_mut().find(|sum| sum.kernel == kernel) {
                None => sums.push(Sum { kernel, dispatches: 1, threads, bytes, operations, time }),
                Some(sum) => {
                    sum.dispatches += 1;
                    sum.threads = sum.threads.min(threads);
                    sum.bytes += bytes;
                    sum.operations = sum.operations.zip(operations).map(|(sum, operations)| sum + operations);
                    sum.time = sum.time.zip(time).map(|(sum, time)| sum + time);
                }
            }
        }
        sums
    }

    /// The table; `rates` are those of the device, where they are known.
    pub fn text(&self, rates: Option<&Rates>, earlier: Option<&Earlier>) -> String {
        let mut text = format!(
            "\n{}: first {:.1} ms, then at least {:.2} ms, median {:.2} ms, {:.0} Mpd/s, {:.0} MB\n",
            self.case.name(),
            milliseconds(self.cold),
            milliseconds(self.warm[0]),
            self.median(),
            self.rate(),
            self.memory as f64 / 1e6,
        );
        if let Some(earlier) = earlier {
            text += &match earlier.median(&self.case.name()) {
                Some(before) => format!("  {:.2} of the earlier median, {before:.2} ms\n", self.median() / before),
                None => "  not measured earlier\n".into(),
            };
        }
        let sums = self.sums();
        let all: Option<f64> = sums.iter().map(|sum| sum.time).sum();
        if all.is_none() {
            text += "  no times of kernels: the device has no timestamps\n";
        }
        let [kernel, time, share, of_copies, of_integers] = ["kernel", "ms", "share", "of copies", "of integers"];
        let [dispatches, threads, bytes] = ["dispatches", "threads", "MB"];
        text += &format!(
            "  {kernel:<20}{dispatches:>10}{threads:>12}{bytes:>10}{time:>10}{share:>9}{of_copies:>11}{of_integers:>13}\n"
        );
        for sum in &sums {
            let or_dash = |cell: Option<String>| cell.unwrap_or_else(|| "-".into());
            let time = or_dash(sum.time.map(|time| format!("{time:.3}")));
            let share = or_dash(sum.time.zip(all).map(|(time, all)| format!("{:.1} %", 100.0 * time / all)));
            let percent = |share: Option<f64>| or_dash(share.map(|share| format!("{:.0} %", 100.0 * share)));
            let of_copies = percent(rates.and_then(|rates| sum.share_of_copies(rates)));
            let of_integers = percent(rates.and_then(|rates| sum.share_of_integers(rates)));
            let threads = or_dash(sum.threads.map(|threads| threads.to_string()));
            let (kernel, dispatches, bytes) = (sum.kernel, sum.dispatches, sum.bytes as f64 / 1e6);
            text += &format!(
                "  {kernel:<20}{dispatches:>10}{threads:>12}{bytes:>10.2}{time:>10}{share:>9}{of_copies:>11}{of_integers:>13}\n"
            );
        }
        text
    }

    /// The figures as JSON.
    pub fn report(&self, rates: Option<&Rates>, earlier: Option<&Earlier>) -> Value {
        let Case { preset, size, range } = self.case;
        let kernel = |sum: &Sum| {
            json!({
                "name": sum.kernel,
                "dispatches": sum.dispatches,
                "threads": sum.threads,
                "bytes": sum.bytes,
                "ms": sum.time,
                "operations": sum.operations,
                "of_copies": rates.and_then(|rates| sum.share_of_copies(rates)),
                "of_integers": rates.and_then(|rates| sum.share_of_integers(rates)),
            })
        };
        json!({
            "preset": preset.name(),
            "width": size.width,
            "height": size.height,
            "disparities": range.count,
            "first_ms": milliseconds(self.cold),
            "least_ms": milliseconds(self.warm[0]),
            "median_ms": self.median(),
            "earlier_median_ms": earlier.and_then(|earlier| earlier.median(&self.case.name())),
            "mpd_per_s": self.rate(),
            "bytes": self.memory,
            "kernels": self.sums().iter().map(kernel).collect::<Vec<_>>(),
        })
    }
}
