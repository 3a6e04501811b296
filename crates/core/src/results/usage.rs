//! Use of time and memory by a process, from `/proc`.

/// Clock ticks per second in `/proc` files: constant on every Linux architecture that Rust targets.
const TICKS_PER_SECOND: f64 = 100.0;

/// CPU time of this process, all threads, user and system [s]; `None` without `/proc`.
pub fn cpu_seconds() -> Option<f64> {
    parse_cpu(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// CPU time of another process, all threads, user and system [s]; `None` without `/proc` or if the process has ended.
pub fn cpu_seconds_of(process: u32) -> Option<f64> {
    parse_cpu(&std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?)
}

/// CPU time of the calling thread [s]; `None` without `/proc`.
pub fn thread_cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    parse_schedule(&text)
}

/// The fields are nanoseconds on the CPU, nanoseconds waiting and time slices
/// (Documentation/scheduler/sched-stats.rst).
fn parse_schedule(schedstat: &str) -> Option<f64> {
    let nanoseconds: f64 = schedstat.split_ascii_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// Peak resident memory of this process [MB = 10⁶ byte]; `None` without `/proc`.
pub fn peak_memory_megabytes() -> Option<f64> {
    parse_peak(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// `pid (name) state …`: utime and stime are fields 14 and 15 of proc(5). The name may contain spaces and brackets,
/// so fields are counted from the last bracket.
fn parse_cpu(stat: &str) -> Option<f64> {
    let mut fields = stat.rsplit_once(')')?.1.split_ascii_whitespace().skip(11);
    let user: u64 = fields.next()?.parse().ok()?;
    let system: u64 = fields.next()?.parse().ok()?;
    Some((user + system) as f64 / TICKS_PER_SECOND)
}

/// `VmHWM:   12345 kB`, where kB means 1024 bytes.
fn parse_peak(status: &str) -> Option<f64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_brackets_does_not_shift_the_fields() {
        let stat = "42 (a) b (c)) R 1 42 42 0 -1 4194560 10 0 0 0 250 30 7 8 20 0 4 0 100 1 2";
        assert_eq!(parse_cpu(stat), Some(2.8));
    }

    #[test]
    fn the_time_of_a_thread_is_read_in_nanoseconds() {
        assert_eq!(parse_schedule("2500000000 17 3\n"), Some(2.5));
        assert_eq!(parse_schedule(""), None);
    }

    #[test]
    fn peak_memory_is_read_in_kibibytes() {
        assert_eq!(
            parse_peak("Name:\tx\nVmHWM:\t    1000 kB\nVmRSS:\t 10 kB\n"),
            Some(1.024)
        );
        assert_eq!(parse_peak("Name:\tx\n"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_uses_memory() {
        assert!(peak_memory_megabytes().unwrap() > 0.1);
        assert!(cpu_seconds().is_some());
    }
}
