//! The columns of a log, by the names in its first line.

/// The expected header, for messages.
pub(super) const EXPECTED: &str =
    "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s or EuRoC's #timestamp [ns],w_RS_S_x [rad s^-1],…";

/// The names before the axis' letter. The first is ours, the second EuRoC's.
const RATES: [&str; 10] =
    ["gyro_", "w_rs_s_", "gyro", "g", "w", "w_", "omega_", "gyro.", "angular_velocity_", "angular_velocity."];
const TIMES: [&str; 4] = ["time", "timestamp", "t", "stamp"];

/// How the columns of a line become a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Columns {
    /// The number of columns.
    pub(super) count: usize,
    /// The index of the time, and the number of its units per second.
    pub(super) time: usize,
    pub(super) per_second: f64,
    /// The indices of the rates, and the radians in one of their units.
    pub(super) rates: [usize; 3],
    pub(super) radians: f64,
}

impl Columns {
    /// The columns of a log without a header: the time in seconds, three rates in rad/s.
    pub(super) const PLAIN: Self =
        Self { count: 4, time: 0, per_second: 1.0, rates: [1, 2, 3], radians: 1.0 };

    /// The columns that a header names.
    pub(super) fn of_header(line: &str) -> Option<Self> {
        let names: Vec<[String; 2]> = line.trim_start_matches('#').split(',').map(name_and_unit).collect();
        let column = |fits: &dyn Fn(&str) -> bool| names.iter().position(|[name, _]| fits(name));
        let time = column(&|name| TIMES.contains(&name))?;
        let per_second = match names[time][1].as_str() {
            "s" | "sec" | "" => 1.0,
            "ms" => 1e3,
            "us" | "µs" => 1e6,
            "ns" => 1e9,
            _ => return None,
        };
        let axis = |letter: char| {
            column(&|name| name.strip_suffix(letter).is_some_and(|stem| RATES.contains(&stem)))
        };
        let rates = [axis('x')?, axis('y')?, axis('z')?];
        let [x, y, z] = rates.map(|i| &names[i][1]);
        if [y, z] != [x, x] {
            return None;
        }
        let radians = match x.as_str() {
            "" => 1.0,
            unit if unit.starts_with("rad") => 1.0,
            unit if unit.starts_with("deg") || unit == "dps" || unit.starts_with('°') => {
                std::f64::consts::PI / 180.0
            }
            _ => return None,
        };
        Some(Self { count: names.len(), time, per_second, rates, radians })
    }
}

/// The name and unit, in lower case, of a field such as `w_RS_S_x [rad s^-1]`, `time(ns)` or `gyro_x_deg_s`.
fn name_and_unit(field: &str) -> [String; 2] {
    let field = field.trim().to_lowercase();
    if let Some((name, unit)) = field.split_once(['[', '(']) {
        return [name.trim().to_owned(), unit.trim_end_matches([']', ')']).trim().to_owned()];
    }
    for unit in ["rad_s", "rad/s", "deg_s", "deg/s", "dps", "ns", "us", "ms", "s"] {
        if let Some(name) = field.strip_suffix(unit).and_then(|name| name.strip_suffix('_')) {
            return [name.to_owned(), unit.to_owned()];
        }
    }
    [field, String::new()]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn headers_in_use_are_understood() {
        let degrees = std::f64::consts::PI / 180.0;
        let of = |line| Columns::of_header(line).unwrap();
        assert_eq!(of("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s"), Columns::PLAIN);
        assert_eq!(of("time_s, gyro_x_deg_s, gyro_y_deg_s, gyro_z_deg_s").radians, degrees);
        assert_eq!(of("t,gx,gy,gz"), Columns::PLAIN);
        assert_eq!(of("t [ms],wx [dps],wy [dps],wz [dps]").per_second, 1e3);
        let euroc = of("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                        a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]");
        assert_eq!(euroc, Columns { count: 7, per_second: 1e9, ..Columns::PLAIN });
        let behind = of("timestamp_us,ax,ay,az,gx,gy,gz");
        assert_eq!(behind, Columns { count: 7, per_second: 1e6, rates: [4, 5, 6], ..Columns::PLAIN });
    }

    #[test]
    fn a_header_without_rates_or_with_unknown_units_is_none() {
        for line in [
            "time_s,a_x,a_y,a_z",
            "gyro_x,gyro_y,gyro_z",
            "time_s,gyro_x,gyro_y",
            "time [weeks],gx,gy,gz",
            "time_s,gx [furlong],gy [furlong],gz [furlong]",
            "time_s,gyro_x_deg_s,gyro_y_rad_s,gyro_z_rad_s",
            "#",
        ] {
            assert_eq!(Columns::of_header(line), None, "{line}");
        }
    }
}
