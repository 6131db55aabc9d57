//! Obstacles from the columns of the danger map: things that stand upright are seen whole.
//!
//! A sector of the map shows a thing at the horizontal distance V / h, where V is the airspeed and h, the *flat rate*,
//! is the sector's rate over the cosine of its elevation. An upright thing has the same flat rate at every height. Of a
//! thin trunk, though, the flow is known in some sectors of its column and not in others; read one by one they leave
//! holes that arcs fly through. So a column is read as a whole:
//!
//! 1. The column's thing is as near as the second highest flat rate above the ground says. One sector alone may be wrong.
//! 2. Neighbouring columns of a like distance show the same thing. Its width follows from their number and its distance.
//! 3. A narrow thing is a post: it fills its column. A wide one, a wall or a beam, reaches from the highest to the
//!    lowest row in which a third of its columns show it, so that a low wall can be flown over and a beam under.
//! 4. A row of many neighbouring sectors at a like distance, as a bar across the path makes it, counts by itself.
//! 5. All other sectors are no nearer than their column's thing.
//!
//! Only rows about the horizon are changed: the aircraft cannot climb or descend into others at once.

use super::{DangerMap, SteerParams};

/// Rows below this elevation show the ground at the usual altitudes, and are no evidence of a thing.
const GROUND_RAD: f64 = -0.35;
/// The rows whose elevation is less than this are those that are changed.
const LEVEL_RAD: f64 = 0.35;
/// Flat rates of one thing differ by less than this ratio.
const ALIKE: f64 = 0.7;
/// The most columns to each side that are searched for the same thing.
const REACH: usize = 6;
/// The share of a wide thing's columns that show it in the rows of its top and its foot.
const SHOWN: f64 = 0.34;
/// The fewest neighbouring sectors of a row that are a bar.
const BAR: usize = 4;

/// The danger map read by columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    /// The flat rate of each sector, row by row.
    flat_hz: Vec<f64>,
    /// That of each column's thing.
    things_hz: Vec<f64>,
    /// The result: the rate of each sector, row by row.
    rates_hz: Vec<f64>,
}

impl Columns {
    /// The rates of the map's sectors, 1/s, row by row, for an aircraft of this airspeed.
    pub(super) fn read(&mut self, params: &SteerParams, map: &DangerMap, speed_m_s: f64) -> &[f64] {
        let grid = &map.grid;
        let (columns, rows) = (grid.columns, grid.rows);
        let elevation_rad = |row: usize| grid.angles_rad(0, row)[1];
        let pitch_rad = grid.pitch_rad()[0].abs();
        self.flat_hz.clear();
        self.flat_hz.extend(
            (map.rates_hz.iter().enumerate()).map(|(at, rate)| rate / elevation_rad(at / columns).cos()),
        );
        self.things_hz.clear();
        for column in 0..columns {
            let above = (0..rows).filter(|row| elevation_rad(*row) > GROUND_RAD);
            self.things_hz.push(second_largest(above.map(|row| self.flat_hz[row * columns + column])));
        }
        self.rates_hz.clone_from(&map.rates_hz);
        for column in 0..columns {
            let thing_hz = self.things_hz[column];
            let same = run(&self.things_hz, column);
            let shown = |row: &usize| {
                let shares = same.clone().map(|column| self.flat_hz[row * columns + column]);
                let count = shares.filter(|flat_hz| *flat_hz >= ALIKE * thing_hz).count();
                elevation_rad(*row) > GROUND_RAD && count as f64 >= SHOWN * same.len() as f64
            };
            let width_m = (same.len() - 1) as f64 * pitch_rad * speed_m_s / thing_hz.max(1e-6);
            let whole = if width_m <= params.post_m {
                Some([0, rows - 1])
            } else {
                (0..rows).find(shown).zip((0..rows).rev().find(shown)).map(|(top, foot)| [top, foot])
            };
            for row in (0..rows).filter(|row| elevation_rad(*row).abs() < LEVEL_RAD) {
                let at = row * columns + column;
                let own_hz = self.flat_hz[at];
                let bar =
                    own_hz > thing_hz && run(&self.flat_hz[row * columns..][..columns], column).len() >= BAR;
                let flat_hz = match whole {
                    _ if bar => own_hz,
                    Some([top, foot]) if (top..=foot).contains(&row) => thing_hz,
                    _ => own_hz.min(thing_hz),
                };
                self.rates_hz[at] = flat_hz * elevation_rad(row).cos();
            }
        }
        &self.rates_hz
    }
}

/// The second largest of some values; 0 if there are fewer.
fn second_largest(values: impl Iterator<Item = f64>) -> f64 {
    let mut largest = [0.0_f64; 2];
    for value in values {
        if value > largest[0] {
            largest = [value, largest[0]];
        } else if value > largest[1] {
            largest[1] = value;
        }
    }
    largest[1]
}

/// The neighbours of one value, itself included, that are all like it: at most [`REACH`] to each side.
fn run(values: &[f64], at: usize) -> std::ops::Range<usize> {
    let alike = |other: &f64| *other >= ALIKE * values[at] && values[at] >= ALIKE * other;
    let before = values[at.saturating_sub(REACH)..at].iter().rev().take_while(|other| alike(other)).count();
    let after = values[at + 1..].iter().take(REACH).take_while(|other| alike(other)).count();
    at - before..at + after + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED_M_S: f64 = 12.0;

    fn params() -> SteerParams {
        SteerParams::default()
    }

    /// A map in which the sectors of these columns and rows show a thing at a horizontal distance, and all others what
    /// is 60 m away.
    fn map(things: &[(std::ops::Range<usize>, &[usize], f64)]) -> DangerMap {
        let mut map = DangerMap::new(&params());
        for row in 0..map.grid.rows {
            for column in 0..map.grid.columns {
                let shown = |(columns, rows, _): &&(std::ops::Range<usize>, &[usize], f64)| {
                    columns.contains(&column) && rows.contains(&row)
                };
                let distance_m = things.iter().find(shown).map_or(60.0, |(_, _, distance_m)| *distance_m);
                let elevation_rad = map.grid.angles_rad(column, row)[1];
                map.rates_hz[row * map.grid.columns + column] = SPEED_M_S / distance_m * elevation_rad.cos();
            }
        }
        map
    }

    /// The horizontal distance that a sector is read at.
    fn read_m(map: &DangerMap, column: usize, row: usize) -> f64 {
        let rate_hz = Columns::default().read(&params(), map, SPEED_M_S)[row * map.grid.columns + column];
        SPEED_M_S / rate_hz * map.grid.angles_rad(column, row)[1].cos()
    }

    /// The default map has seven rows of 8°: row 3 is level, 1 to 5 are changed, and 6 shows the ground.
    #[test]
    fn rows_of_the_default_map() {
        let map = map(&[]);
        let changed = |row: &usize| map.grid.angles_rad(0, *row)[1].abs() < LEVEL_RAD;
        assert_eq!((0..map.grid.rows).filter(changed).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        assert!(map.grid.angles_rad(0, 3)[1].abs() < 1e-12 && map.grid.angles_rad(0, 6)[1] < GROUND_RAD);
    }

    #[test]
    fn a_post_fills_the_holes_of_its_column() {
        let map = map(&[(10..11, &[1, 4], 9.0)]);
        for row in 1..=5 {
            assert!((read_m(&map, 10, row) - 9.0).abs() < 1e-9, "row {row}");
            assert!((read_m(&map, 11, row) - 60.0).abs() < 1e-9, "row {row}");
        }
    }

    #[test]
    fn one_sector_alone_and_the_ground_are_no_things() {
        let map = map(&[(10..11, &[3], 9.0), (0..29, &[6], 20.0)]);
        for row in 1..=5 {
            assert!((read_m(&map, 10, row) - 60.0).abs() < 1e-9, "row {row}");
        }
    }

    #[test]
    fn a_low_wall_is_open_above_and_a_beam_below() {
        let wall = map(&[(5..25, &[3, 4, 5], 12.0)]);
        let beam = map(&[(5..25, &[1, 2], 12.0)]);
        for column in [6, 15, 23] {
            let open = |map: &DangerMap, row: usize| read_m(map, column, row) > 50.0;
            assert_eq!([1, 2, 3, 4, 5].map(|row| open(&wall, row)), [true, true, false, false, false]);
            assert_eq!([1, 2, 3, 4, 5].map(|row| open(&beam, row)), [false, false, true, true, true]);
        }
    }

    /// A wall that some of its columns show in other rows than the rest has no holes between its top and its foot.
    #[test]
    fn a_wall_has_no_holes() {
        let map = map(&[(5..15, &[1, 3, 5], 12.0), (15..25, &[1, 2, 4, 5], 12.0)]);
        for row in 1..=5 {
            assert!((read_m(&map, 14, row) - 12.0).abs() < 1e-9, "row {row}");
        }
    }

    #[test]
    fn a_bar_across_the_path_counts_in_its_own_row() {
        let long = map(&[(8..14, &[3], 12.0)]);
        let short = map(&[(8..11, &[3], 12.0)]);
        assert!((read_m(&long, 10, 3) - 12.0).abs() < 1e-9 && read_m(&long, 10, 2) > 50.0);
        assert!(read_m(&short, 10, 3) > 50.0);
    }

    #[test]
    fn runs_end_at_what_is_unlike_and_at_the_reach() {
        assert_eq!(run(&[1.0, 1.2, 3.0, 1.0], 1), 0..2);
        assert_eq!(run(&[1.0; 40], 20), 14..27);
        assert_eq!(run(&[1.0], 0), 0..1);
        assert_eq!(
            (second_largest([1.0].into_iter()), second_largest([2.0, 5.0, 3.0].into_iter())),
            (0.0, 3.0)
        );
    }
}
