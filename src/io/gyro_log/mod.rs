//! Log files of gyro samples: comma-separated text, one sample per line.

mod columns;

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use glam::DVec3;

use self::columns::{Columns, EXPECTED};
use crate::error::{Error, Result};
use crate::imu::GyroSample;
use crate::io::write_atomic;

/// The longest line, so that a file of another kind is not read into memory whole.
const MAX_LINE: u64 = 4096;

/// Reads the samples of a log, in the order of its lines.
///
/// The first line may name the columns: [`write()`] writes `time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s`, and EuRoC's
/// `#timestamp [ns],w_RS_S_x [rad s^-1],…` is understood as well, with further columns and in any order, with times
/// in s, ms, µs or ns and rates in rad/s or deg/s. Without such a line there are four columns: seconds and three
/// rates in rad/s.
///
/// Samples that are not finite (`nan`) and those that run backwards in time are kept:
/// [`Gyro`](crate::imu::Gyro) decides which frames they invalidate.
///
/// # Errors
/// [`Error::Io`]; [`Error::Format`] naming the line that has another number of columns or a word instead of a number;
/// for a header that names no gyro; for a log without samples.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<GyroSample>> {
    let path = path.as_ref();
    let file = File::open(path).map_err(|source| Error::io(path, source))?;
    decode(path, BufReader::new(file))
}

/// Decodes a log from any reader, as [`read`] does. `path` is the name for error messages.
///
/// # Errors
/// As in [`read`].
pub fn decode(path: &Path, mut log: impl BufRead) -> Result<Vec<GyroSample>> {
    let mut samples = Vec::new();
    let mut columns = None;
    let mut bytes = Vec::new();
    for number in 1_u64.. {
        bytes.clear();
        let read = log.by_ref().take(MAX_LINE + 1).read_until(b'\n', &mut bytes);
        if read.map_err(|source| Error::io(path, source))? == 0 {
            break;
        }
        let wrong = |found: &str, expected: &str| {
            Err(Error::format(path, "gyro log", format!("{found:?} in line {number}"), expected))
        };
        if bytes.len() as u64 > MAX_LINE {
            return wrong("a longer line", "lines of at most 4096 bytes");
        }
        let line = String::from_utf8_lossy(&bytes);
        // Spreadsheets start a text with a byte order mark.
        let line = line.trim_start_matches('\u{feff}').trim();
        if line.is_empty() {
            continue;
        }
        if columns.is_none() {
            let first = line.split(',').next().unwrap_or_default();
            if line.starts_with('#') || first.trim().parse::<f64>().is_err() {
                columns = Columns::of_header(line);
                if columns.is_none() {
                    return wrong(&shorten(line), EXPECTED);
                }
                continue;
            }
        }
        let columns = columns.get_or_insert(Columns::PLAIN);
        match sample(line, columns) {
            Some(sample) => samples.push(sample),
            None => return wrong(&shorten(line), &format!("{} numbers, comma-separated", columns.count)),
        }
    }
    if samples.is_empty() {
        return Err(Error::format(path, "number of gyro samples", 0, "at least 1"));
    }
    Ok(samples)
}

fn sample(line: &str, columns: &Columns) -> Option<GyroSample> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    if fields.len() != columns.count {
        return None;
    }
    let number = |i: usize| fields[i].parse::<f64>().ok();
    let rate = |axis: usize| Some(number(columns.rates[axis])? * columns.radians);
    Some(GyroSample {
        time_s: number(columns.time)? / columns.per_second,
        gyro_rad_s: DVec3::new(rate(0)?, rate(1)?, rate(2)?),
    })
}

/// A line, shortened for a message.
fn shorten(line: &str) -> String {
    match line.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// Writes a log atomically. [`read`] returns the same numbers to the last bit.
///
/// # Errors
/// [`Error::Io`].
pub fn write(path: impl AsRef<Path>, samples: &[GyroSample]) -> Result<()> {
    let path = path.as_ref();
    write_atomic(path, |out| {
        let mut line = |text: String| writeln!(out, "{text}").map_err(|source| Error::io(path, source));
        line("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s".to_owned())?;
        for GyroSample { time_s, gyro_rad_s: DVec3 { x, y, z } } in samples {
            line(format!("{time_s},{x},{y},{z}"))?;
        }
        Ok(())
    })
}
