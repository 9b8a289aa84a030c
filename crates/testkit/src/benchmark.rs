//! Benchmarks: how long something takes, and the tables of docs/performance.md.

use std::fs::{self, OpenOptions};
use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

/// Longest time spent on repeating one measurement.
const PATIENCE: Duration = Duration::from_secs(1);
/// Most repetitions.
const MOST_RUNS: usize = 200;
/// Fewest repetitions, of work that takes less than [`PATIENCE`].
const FEWEST_RUNS: usize = 5;
/// Work of microseconds is repeated for so long as one measurement.
const SHORTEST: Duration = Duration::from_micros(500);
/// Names the file that collects the figures: `just bench` sets it.
const COLLECTED: &str = "CRUMPLE_BENCH";
/// Set where callgrind counts instead of a clock: `just instructions` sets it.
const COUNTED: &str = "CRUMPLE_BENCH_COUNTED";
/// How often [`counted`] was called.
static CALLS: AtomicU32 = AtomicU32::new(0);

/// The work that callgrind counts, by the name of this function: it writes a file behind each call.
#[inline(never)]
pub fn counted<T>(work: &mut impl FnMut() -> T) {
    drop(black_box(work()));
}

/// Shortest time of some runs of `work`, s, of one run where it takes over a second: what else runs on the machine only
/// adds. What it returns is used, so that the work is not left out; whatever is allocated and freed counts.
///
/// Where callgrind counts, a second call is counted and no time is taken.
pub fn best_s<T>(mut work: impl FnMut() -> T) -> f64 {
    if std::env::var_os(COUNTED).is_some() {
        drop(black_box(work()));
        counted(&mut work);
        CALLS.fetch_add(1, Relaxed);
        return 0.0;
    }
    let started = Instant::now();
    drop(black_box(work()));
    let first = started.elapsed();
    let calls = (SHORTEST.as_secs_f64() / first.as_secs_f64()).clamp(1.0, 1e5) as u32;
    let mut best = first.as_secs_f64();
    for run in 1..MOST_RUNS {
        if started.elapsed() > PATIENCE && (run >= FEWEST_RUNS || first > PATIENCE) {
            break;
        }
        let start = Instant::now();
        (0..calls).for_each(|_| drop(black_box(work())));
        best = best.min(start.elapsed().as_secs_f64() / f64::from(calls));
    }
    best
}

/// A plain memory pass over samples: each is read and written to a buffer that is there already, s.
pub fn memory_pass_s<T: Copy>(samples: &[T]) -> f64 {
    if std::env::var_os(COUNTED).is_some() {
        return 1.0;
    }
    let mut copy = samples.to_vec();
    best_s(|| {
        copy.copy_from_slice(black_box(samples));
        black_box(copy[samples.len() / 2])
    })
}

/// One measurement.
#[derive(Debug, Deserialize, Serialize)]
pub struct Figure {
    /// What was done.
    pub work: String,
    /// How long it took.
    pub seconds: f64,
    /// A memory pass over the same data.
    pub pass_s: f64,
    /// What it should take at most; such figures stand in docs/performance.md.
    pub aim_s: Option<f64>,
    /// What another program takes, measured elsewhere.
    pub peer: Option<String>,
    /// Process and call of [`counted`], where callgrind counts.
    #[serde(default)]
    pub call: Option<(u32, u32)>,
}

impl Figure {
    /// A time beside that of a memory pass over the same data, s.
    pub fn new(work: impl Into<String>, seconds: f64, pass_s: f64) -> Self {
        let call = std::env::var_os(COUNTED).map(|_| (std::process::id(), CALLS.load(Relaxed)));
        Self { work: work.into(), seconds, pass_s, aim_s: None, peer: None, call }
    }

    /// With what it should take at most, s, and what another program takes: `scipy 10 ms`.
    pub fn aim(mut self, seconds: f64, peer: &str) -> Self {
        self.aim_s = Some(seconds);
        self.peer = (!peer.is_empty()).then(|| peer.to_owned());
        self
    }

    /// Prints it, and adds it to the file of `just bench`.
    pub fn print(&self) {
        let aim = self.aim_s.map_or_else(String::new, |aim| format!(", aim {}", duration(aim)));
        let passes = self.seconds / self.pass_s;
        println!("{:<62} {:>9} {passes:>9.1} x memory pass{aim}", self.work, duration(self.seconds));
        if let Some(path) = std::env::var_os(COLLECTED) {
            let mut line = serde_json::to_string(self).expect("numbers and texts");
            line.push('\n');
            let file = OpenOptions::new().create(true).append(true).open(path);
            file.and_then(|mut file| file.write_all(line.as_bytes()))
                .expect("the file of CRUMPLE_BENCH can be written");
        }
    }

    fn row(&self) -> String {
        let Self { work, seconds, pass_s, aim_s, peer, .. } = self;
        let aim = aim_s.map_or_else(String::new, duration);
        let mark = if aim_s.is_some_and(|aim| *seconds > aim) { "**" } else { "" };
        let work = work.trim();
        let (time, passes, peer) = (duration(*seconds), seconds / pass_s, peer.as_deref().unwrap_or(""));
        format!("| {work} | {mark}{time}{mark} | {aim} | {passes:.0} | {peer} |\n")
    }
}

/// A time with two digits or three.
fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 0.9995e-3 => (1e6 * s, "µs"),
        s if s < 0.9995 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let decimals = match value {
        v if v < 9.995 => 2,
        v if v < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.decimals$} {unit}")
}

/// What a run of a record costs.
struct Cost {
    wall_s: f64,
    cpu_s: f64,
    peak_mib: f64,
    folder_mb: f64,
    again_s: f64,
}

/// Seconds of processors that ended children took.
fn children_s() -> std::io::Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    let fields = stat.rsplit(") ").next().unwrap_or_default();
    // Fields 16 and 17 of proc(5), the third is the first here; in hundredths of a second.
    Ok(fields.split(' ').skip(13).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0)
}

/// The shortest of so many runs of `crumple run` in a new folder, then where it is up to date; memory by a run of its
/// own. Errors: a run that fails.
fn cost(crumple: &Path, record: &Path, times: u32) -> std::io::Result<Cost> {
    let folder = std::env::temp_dir().join(format!("crumple-bench-{}", std::process::id()));
    let mut cost = Cost { wall_s: f64::INFINITY, cpu_s: f64::INFINITY, peak_mib: 0.0, folder_mb: 0.0, again_s: 1e9 };
    let run = |peak_mib: Option<&mut f64>| -> std::io::Result<[f64; 2]> {
        let (before, start) = (children_s()?, Instant::now());
        let mut command = Command::new(crumple);
        let mut child =
            command.arg("run").arg(record).arg("-q").arg("-o").arg(&folder).stderr(Stdio::null()).spawn()?;
        if let Some(peak_mib) = peak_mib {
            while child.try_wait()?.is_none() {
                let text = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
                let peak = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
                let kib = peak.and_then(|peak| peak.trim().trim_end_matches(" kB").parse::<f64>().ok());
                *peak_mib = peak_mib.max(kib.unwrap_or(0.0) / 1024.0);
                std::thread::sleep(Duration::from_micros(200));
            }
        }
        // The fixtures that rebound like no car have a result too.
        if !child.wait()?.success() {
            return Err(std::io::Error::other(format!("crumple run {} failed", record.display())));
        }
        Ok([start.elapsed().as_secs_f64(), children_s()? - before])
    };
    run(Some(&mut cost.peak_mib))?;
    for entry in fs::read_dir(&folder)? {
        cost.folder_mb += entry?.metadata()?.len() as f64 / 1e6;
    }
    for _ in 0..times {
        fs::remove_dir_all(&folder)?;
        let [wall_s, cpu_s] = run(None)?;
        (cost.wall_s, cost.cpu_s) = (cost.wall_s.min(wall_s), cost.cpu_s.min(cpu_s));
    }
    for _ in 0..times {
        cost.again_s = cost.again_s.min(run(None)?[0]);
    }
    fs::remove_dir_all(&folder)?;
    Ok(cost)
}

/// Times the peer, a Python script that does the same job, and `crumple run` in turns, as rows of a table: what else
/// runs on the machine slows both.
///
/// # Errors
/// A program that does not start or fails.
pub fn beside_peer(crumple: &Path, python: &Path, turns: usize) -> std::io::Result<String> {
    let folder = std::env::temp_dir().join(format!("crumple-peer-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let made = folder.join("made.csv");
    fs::write(&made, made_crash(1e4))?;
    let fixture = crate::workspace().join("fixtures/elastoplastic/crash.csv");
    let script = crate::workspace().join("scripts/peer.py");
    let timed = |command: &mut Command| -> std::io::Result<f64> {
        let start = Instant::now();
        let output = command.output()?;
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_done = output.status.success();
        is_done.then(|| start.elapsed().as_secs_f64()).ok_or_else(|| std::io::Error::other(said))
    };
    let mut text = String::from("| record | the script | `crumple run` | ratio |\n|---|--:|--:|--:|\n");
    for (name, record) in [("fixture `elastoplastic`", &fixture), ("one crash at 10 kHz", &made)] {
        let (mut peer, mut own, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..turns {
            let of_peer = timed(Command::new(python).arg(&script).arg(record).arg(folder.join("peer")))?;
            let run = folder.join("run");
            let of_own = timed(Command::new(crumple).arg("run").arg(record).arg("-q").arg("-o").arg(&run))?;
            fs::remove_dir_all(&run)?;
            peer.push(of_peer);
            own.push(of_own);
            ratios.push(of_peer / of_own);
        }
        let middle = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let ratio = middle(ratios);
        text += &format!("| {name} | {} | {} | {ratio:.1} |\n", duration(middle(peer)), duration(middle(own)));
    }
    fs::remove_dir_all(&folder)?;
    Ok(text)
}

/// One made crash of a quarter of a second at a rate, as a table.
pub(crate) fn made_crash(rate_hz: f64) -> String {
    let mut text = String::from("# mass: 1200 kg\n# impact speed: 50 km/h\ntime_s,accel_g\n");
    let end = (0.25 * rate_hz) as usize;
    for k in 0..=end {
        let t = k as f64 / rate_hz;
        let pulse = if t < 0.11 { -20.5 * (std::f64::consts::PI * t / 0.11).sin() } else { 0.0 };
        let ripple = 2.0 * (400.0 * t).sin() * (-20.0 * t).exp();
        text.push_str(&format!("{t:.8},{:.6}\n", pulse + ripple));
    }
    text
}

/// The line of docs/performance.md above its tables.
pub const BEGIN: &str = "<!-- just bench writes these tables -->\n";
/// The line below them.
pub const END: &str = "<!-- end of the tables -->";

/// The tables of docs/performance.md: whole runs of fixtures and of one crash at several rates, and the figures with an
/// aim that the benchmarks collected.
pub fn tables(crumple: &Path, figures: &[Figure]) -> std::io::Result<String> {
    let cpu = fs::read_to_string("/proc/cpuinfo")?;
    let cpu = cpu.lines().find_map(|line| line.strip_prefix("model name\t: ")).unwrap_or("unknown processor");
    let cores = std::thread::available_parallelism()?;
    let mut text = format!("Machine: {cpu}, {cores} cores.\n\n");
    text +=
        "| record | samples | wall | CPU | peak memory | folder | nothing changed |\n|---|---|---|---|---|---|---|\n";
    let mut row = |name: &str, record: &Path, samples: usize| -> std::io::Result<()> {
        let Cost { wall_s, cpu_s, peak_mib, folder_mb, again_s } = cost(crumple, record, 15)?;
        let (wall, cpu, again) = (duration(wall_s), duration(cpu_s), duration(again_s));
        text += &format!("| {name} | {samples} | {wall} | {cpu} | {peak_mib:.0} MiB | {folder_mb:.1} MB | {again} |\n");
        Ok(())
    };
    for fixture in ["kelvin", "elastoplastic", "double", "noisy"] {
        let record = crate::workspace().join("fixtures").join(fixture).join("crash.csv");
        row(&format!("fixture `{fixture}`"), &record, 2501)?;
    }
    let record = std::env::temp_dir().join(format!("crumple-bench-{}.csv", std::process::id()));
    for (name, rate_hz) in [("10 kHz", 1e4), ("100 kHz", 1e5), ("1 MHz", 1e6), ("4 MHz", 4e6)] {
        fs::write(&record, made_crash(rate_hz))?;
        row(&format!("one crash at {name}"), &record, (0.25 * rate_hz) as usize + 1)?;
    }
    fs::remove_file(&record)?;
    text += "\n| work | time | aim | memory passes | peer |\n|---|---|---|---|---|\n";
    figures.iter().filter(|figure| figure.aim_s.is_some()).for_each(|figure| text += &figure.row());
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_its_time_in_a_unit_that_fits_and_marks_a_missed_aim() {
        let shown = [80e-9, 5e-6, 999.96e-6, 42.3e-3, 0.434, 23.0].map(duration);
        assert_eq!(shown, ["0.08 µs", "5.00 µs", "1.00 ms", "42.3 ms", "434 ms", "23.0 s"]);
        let row = Figure::new("filter", 6e-3, 1e-3).aim(5e-3, "scipy 10 ms").row();
        assert_eq!(row, "| filter | **6.00 ms** | 5.00 ms | 6 | scipy 10 ms |\n");
    }
}
