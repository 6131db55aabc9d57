//! Threats and alarms: sectors on a collision course, confirmed over several sectors and frames.

use super::grid::{Grid, angles_rad};
use super::motion::Heading;
use super::sectors::Sectors;
use crate::error::{Error, Result};

/// The criteria of threats and alarms.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Alarm {
    /// The longest time to contact of a threat, in seconds, above 0 and at most 60.
    pub within_s: f64,
    /// The largest miss distance of a threat, in seconds of flight, 0 to 60: 0.4 s is 2 m at 5 m/s.
    pub aside_s: f64,
    /// The least number of connected sectors in a threat, at least 1.
    pub least_sectors: usize,
    /// Consecutive frames in which a threat must be seen to be an alarm, at least 1.
    pub frames: u32,
    /// The least coverage of a sector that counts, 0 to 1.
    pub least_coverage: f64,
}

impl Default for Alarm {
    fn default() -> Self {
        Self { within_s: 2.0, aside_s: 0.4, least_sectors: 2, frames: 2, least_coverage: 0.3 }
    }
}

impl Alarm {
    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        if !(self.within_s > 0.0 && self.within_s <= 60.0) {
            return Err(Error::parameter("within_s", self.within_s, "above 0 and at most 60"));
        }
        if !(0.0..=60.0).contains(&self.aside_s) {
            return Err(Error::parameter("aside_s", self.aside_s, "0 to 60"));
        }
        if !(0.0..=1.0).contains(&self.least_coverage) {
            return Err(Error::parameter("least_coverage", self.least_coverage, "0 to 1"));
        }
        if self.least_sectors == 0 {
            return Err(Error::parameter("least_sectors", 0, "at least 1"));
        }
        if self.frames == 0 {
            return Err(Error::parameter("frames", 0, "at least 1"));
        }
        Ok(())
    }
}

/// Connected sectors on a collision course: something that will be met soon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threat {
    /// Azimuth of its centre in the camera's frame, positive to the right.
    pub azimuth_rad: f64,
    /// Elevation of its centre, positive up.
    pub elevation_rad: f64,
    /// Time to contact with its nearest part, in seconds from the later frame.
    pub time_s: f64,
    /// Number of its sectors.
    pub sectors: usize,
    /// Whether it was seen in as many consecutive frames as an alarm needs: [`Alarm::frames`].
    pub alarm: bool,
}

/// Finds threats: connected sectors on a collision course, frame by frame.
///
/// With the nearness rate N at an angle θ from the heading, an object will be passed in `cos θ / N` seconds at a miss
/// distance of `sin θ / N` seconds of flight. With the default criteria neither a single sector nor a single frame
/// raises an alarm, so that an outlier does not.
#[derive(Clone, Debug)]
pub struct AlarmFilter {
    alarm: Alarm,
    /// For how many consecutive frames each sector has been part of a threat.
    ages: Vec<u32>,
}

impl AlarmFilter {
    /// A filter for a grid of sectors.
    ///
    /// # Errors
    /// As [`Alarm::validate`].
    pub fn new(alarm: Alarm, grid: &Grid) -> Result<Self> {
        alarm.validate()?;
        Ok(Self { alarm, ages: vec![0; grid.len()] })
    }

    /// Forgets all previous frames.
    pub fn reset(&mut self) {
        self.ages.fill(0);
    }

    /// The threat with the earliest contact, alarms before others; `None` without a threat. `sectors` must have the
    /// filter's grid.
    pub fn update(&mut self, sectors: &Sectors, heading: &Heading) -> Option<Threat> {
        let grid = sectors.grid;
        let times: Vec<Option<f64>> = (0..grid.len()).map(|i| self.time_s(sectors, heading, i)).collect();
        let mut ages = vec![0; grid.len()];
        let mut seen = vec![false; grid.len()];
        let mut threats = Vec::new();
        for first in 0..grid.len() {
            if seen[first] || times[first].is_none() {
                continue;
            }
            let blob = connected(&grid, first, &times, &mut seen);
            if blob.len() < self.alarm.least_sectors {
                continue;
            }
            let age = 1 + blob.iter().map(|at| self.age_around(&grid, *at)).max().unwrap_or(0);
            blob.iter().for_each(|at| ages[*at] = age);
            threats.push(threat(&grid, &blob, &times, age >= self.alarm.frames));
        }
        self.ages = ages;
        threats.into_iter().min_by(|a, b| b.alarm.cmp(&a.alarm).then(a.time_s.total_cmp(&b.time_s)))
    }

    /// The time to contact of a sector, in seconds along the heading, if it meets the criteria.
    fn time_s(&self, sectors: &Sectors, heading: &Heading, at: usize) -> Option<f64> {
        let sector = &sectors.sectors[at];
        if !(sector.coverage >= self.alarm.least_coverage) {
            return None;
        }
        let contact_s = sectors.time_to_contact_s(sector)[1]?;
        let grid = &sectors.grid;
        // With an unknown heading, any direction may be straight ahead.
        let cosine = match heading.is_known() {
            true => grid.bearing(at % grid.columns, at / grid.columns).dot(heading.direction),
            false => 1.0,
        };
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let time_s = contact_s * cosine;
        (cosine > 0.0 && time_s < self.alarm.within_s && contact_s * sine < self.alarm.aside_s)
            .then_some(time_s)
    }

    /// The largest age of this sector and its neighbours in the previous frame.
    fn age_around(&self, grid: &Grid, at: usize) -> u32 {
        let (column, row) = (at % grid.columns, at / grid.columns);
        let columns = column.saturating_sub(1)..(column + 2).min(grid.columns);
        let rows = row.saturating_sub(1)..(row + 2).min(grid.rows);
        let around = rows.flat_map(|row| columns.clone().map(move |column| row * grid.columns + column));
        around.map(|at| self.ages[at]).max().unwrap_or(0)
    }
}

/// The sectors connected to this one by their sides.
fn connected(grid: &Grid, first: usize, times: &[Option<f64>], seen: &mut [bool]) -> Vec<usize> {
    let mut blob = vec![first];
    seen[first] = true;
    let mut next = 0;
    while let Some(&at) = blob.get(next) {
        next += 1;
        let (column, row) = (at % grid.columns, at / grid.columns);
        let beside = [
            (column > 0).then(|| at - 1),
            (column + 1 < grid.columns).then(|| at + 1),
            (row > 0).then(|| at - grid.columns),
            (row + 1 < grid.rows).then(|| at + grid.columns),
        ];
        for at in beside.into_iter().flatten().filter(|at| times[*at].is_some()) {
            if !std::mem::replace(&mut seen[at], true) {
                blob.push(at);
            }
        }
    }
    blob
}

fn threat(grid: &Grid, blob: &[usize], times: &[Option<f64>], alarm: bool) -> Threat {
    let mut soonest: Vec<(f64, usize)> = blob.iter().filter_map(|at| Some((times[*at]?, *at))).collect();
    soonest.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The second soonest, where there is one: the soonest may be an outlier.
    let time_s = soonest[1.min(soonest.len() - 1)].0;
    let sum: glam::DVec3 = soonest
        .iter()
        .map(|(time, at)| grid.bearing(at % grid.columns, at / grid.columns) / time.max(0.05))
        .sum();
    let [azimuth_rad, elevation_rad] = angles_rad(sum);
    Threat { azimuth_rad, elevation_rad, time_s, sectors: blob.len(), alarm }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn quiet() -> Sectors {
        let grid = Grid { columns: 12, rows: 5, azimuth_rad: [-0.6, 0.6], elevation_rad: [0.3, -0.3] };
        let mut sectors = Sectors::unknown(grid);
        for sector in &mut sectors.sectors {
            (sector.coverage, sector.nearness_rate_hz) = (1.0, [0.05; 3]);
        }
        sectors
    }

    fn with(near: &[(usize, usize)], rate_hz: f64) -> Sectors {
        let mut sectors = quiet();
        for (column, row) in near {
            sectors.sectors[row * 12 + column].nearness_rate_hz = [rate_hz; 3];
        }
        sectors
    }

    const AHEAD: Heading = Heading { direction: glam::DVec3::Z, error_rad: 0.01 };

    #[test]
    fn an_alarm_needs_two_sectors_and_two_frames() {
        let mut filter = AlarmFilter::new(Alarm::default(), &quiet().grid).unwrap();
        assert_eq!(filter.update(&quiet(), &AHEAD), None);
        // A single outlying sector, over any number of frames.
        for _ in 0..3 {
            assert_eq!(filter.update(&with(&[(5, 2)], 1.0), &AHEAD), None);
        }
        let near = with(&[(5, 2), (6, 2)], 1.0);
        let first = filter.update(&near, &AHEAD).unwrap();
        assert!(!first.alarm && first.sectors == 2, "{first:?}");
        // It may move by a sector.
        let second = filter.update(&with(&[(6, 2), (7, 2)], 1.0), &AHEAD).unwrap();
        assert!(second.alarm && (second.time_s - 1.0).abs() < 0.02 && second.azimuth_rad > 0.0, "{second:?}");
        assert_eq!(filter.update(&quiet(), &AHEAD), None);
        assert!(!filter.update(&near, &AHEAD).unwrap().alarm);
        filter.reset();
        assert!(!filter.update(&near, &AHEAD).unwrap().alarm);
    }

    #[test]
    fn what_is_passed_far_aside_is_no_threat() {
        let mut filter = AlarmFilter::new(Alarm::default(), &quiet().grid).unwrap();
        let aside = with(&[(0, 2), (1, 2), (0, 3)], 0.7);
        assert_eq!(filter.update(&aside, &AHEAD), None);
        let there = Heading { direction: aside.grid.bearing(0, 2), error_rad: 0.01 };
        assert!(filter.update(&aside, &there).is_some());
        assert!(filter.update(&aside, &Heading::UNKNOWN).is_some());
        // Corners do not connect.
        assert_eq!(filter.update(&with(&[(5, 2), (6, 3)], 1.0), &AHEAD), None);
    }

    #[test]
    fn alarms_come_before_what_is_sooner() {
        let mut filter = AlarmFilter::new(Alarm::default(), &quiet().grid).unwrap();
        let slow = [(5, 1), (6, 1)];
        filter.update(&with(&slow, 0.8), &AHEAD);
        let mut both = with(&slow, 0.8);
        for (column, row) in [(5, 4), (6, 4)] {
            both.sectors[row * 12 + column].nearness_rate_hz = [2.0; 3];
        }
        let found = filter.update(&both, &AHEAD).unwrap();
        assert!(found.alarm && found.elevation_rad > 0.0, "{found:?}");
    }

    #[test]
    fn parameters_are_checked() {
        let grid = quiet().grid;
        for alarm in [
            Alarm { within_s: 0.0, ..Alarm::default() },
            Alarm { aside_s: f64::NAN, ..Alarm::default() },
            Alarm { least_sectors: 0, ..Alarm::default() },
            Alarm { frames: 0, ..Alarm::default() },
            Alarm { least_coverage: 1.5, ..Alarm::default() },
        ] {
            assert!(AlarmFilter::new(alarm, &grid).is_err(), "{alarm:?}");
        }
    }
}
