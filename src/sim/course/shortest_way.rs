//! The shortest way through a course: what a pilot who knows the world would fly at the altitude of the start.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::{Course, heading};

/// The distance of neighbouring places of the search, metres.
const PITCH_M: f64 = 0.5;
/// Ways lead at most this far behind the start and beside the straight line, metres.
const BEHIND_M: f64 = 10.0;
const ASIDE_M: f64 = 60.0;
/// The least advance along a line that is checked for obstacles, metres.
const ADVANCE_M: f64 = 0.01;
/// The steps to the neighbours of a place, along the path and to its right.
const NEIGHBOURS: [[i32; 2]; 8] = [[1, 0], [1, 1], [1, -1], [0, 1], [0, -1], [-1, 1], [-1, -1], [-1, 0]];

impl Course {
    /// The length of the shortest way on which a ball of this radius reaches the goal at the altitude of the start,
    /// metres; `None` if there is none within 60 m of the straight line.
    ///
    /// It is found by A* (P. E. Hart, N. J. Nilsson and B. Raphael, A formal basis for the heuristic determination of
    /// minimum cost paths, IEEE Trans. Systems Science and Cybernetics 4, 1968) on a grid of 0.5 m, whose turns are then
    /// cut where the straight line is free. It is up to some per cent longer than the true one, and ignores how fast an
    /// aircraft can turn.
    pub fn shortest_way_m(&self, radius_m: f64) -> Option<f64> {
        let search = Search::new(self, radius_m);
        let way = search.way()?;
        Some(search.cut(&way).windows(2).map(|ends| ends[0].distance(ends[1])).sum())
    }
}

/// A grid of places over the course, row by row from behind the start to the goal.
struct Search<'a> {
    course: &'a Course,
    radius_m: f64,
    rows: i32,
    columns: i32,
}

/// A place in the queue: the length of the shortest way through it, as the bits of a positive number, which are in its
/// order; and its index.
type Queued = Reverse<(u64, usize)>;

impl<'a> Search<'a> {
    fn new(course: &'a Course, radius_m: f64) -> Self {
        let rows = ((BEHIND_M + course.length_m) / PITCH_M).ceil() as i32 + 1;
        let columns = 2 * (ASIDE_M / PITCH_M) as i32 + 1;
        Self { course, radius_m, rows, columns }
    }

    /// The point of a place: north and east, relative to the start.
    fn point(&self, index: usize) -> DVec2 {
        let [row, column] = self.place(index);
        let along = f64::from(row) * PITCH_M - BEHIND_M;
        let aside = f64::from(column - self.columns / 2) * PITCH_M;
        let north = heading(self.course.goal_yaw_rad);
        north * along + north.perp() * aside
    }

    fn place(&self, index: usize) -> [i32; 2] {
        let columns = self.columns as usize;
        [(index / columns) as i32, (index % columns) as i32]
    }

    fn index(&self, [row, column]: [i32; 2]) -> Option<usize> {
        let is_inside = (0..self.rows).contains(&row) && (0..self.columns).contains(&column);
        is_inside.then_some((row * self.columns + column) as usize)
    }

    /// What is still to fly from a place at least.
    fn rest_m(&self, index: usize) -> f64 {
        (self.course.length_m - self.point(index).dot(heading(self.course.goal_yaw_rad))).max(0.0)
    }

    /// Whether the ball can fly straight from one point to another.
    fn is_free(&self, from: DVec2, to: DVec2) -> bool {
        let length_m = from.distance(to);
        let mut at_m = 0.0;
        loop {
            let point = from.lerp(to, if length_m > 0.0 { at_m / length_m } else { 0.0 });
            let clearance_m = self.course.world.clearance_m(self.course.start_ned_m + point.extend(0.0));
            if !(clearance_m >= self.radius_m) {
                return false;
            }
            if at_m >= length_m {
                return true;
            }
            // Nothing is nearer to the points up to there than the radius.
            at_m = (at_m + (clearance_m - self.radius_m).max(ADVANCE_M)).min(length_m);
        }
    }

    /// The places of the shortest way along the grid, from the start to the goal.
    fn way(&self) -> Option<Vec<usize>> {
        let start = self.index([(BEHIND_M / PITCH_M) as i32, self.columns / 2])?;
        let places = (self.rows * self.columns) as usize;
        let (mut lengths_m, mut before, mut is_done) =
            (vec![f64::INFINITY; places], vec![start; places], vec![false; places]);
        lengths_m[start] = 0.0;
        let mut queue: BinaryHeap<Queued> = [Reverse((0, start))].into();
        while let Some(Reverse((_, at))) = queue.pop() {
            if std::mem::replace(&mut is_done[at], true) {
                continue;
            }
            if self.rest_m(at) <= 0.0 {
                let back = std::iter::successors(Some(at), |&at| (at != start).then(|| before[at]));
                let mut way: Vec<usize> = back.collect();
                way.reverse();
                return Some(way);
            }
            let [row, column] = self.place(at);
            for [along, aside] in NEIGHBOURS {
                let Some(next) = self.index([row + along, column + aside]).filter(|next| !is_done[*next])
                else {
                    continue;
                };
                let length_m = lengths_m[at] + PITCH_M * f64::from(along * along + aside * aside).sqrt();
                if length_m < lengths_m[next] && self.is_free(self.point(at), self.point(next)) {
                    (lengths_m[next], before[next]) = (length_m, at);
                    queue.push(Reverse(((length_m + self.rest_m(next)).to_bits(), next)));
                }
            }
        }
        None
    }

    /// The corners that remain where each is left out behind which the straight line is free, until none is.
    fn cut(&self, way: &[usize]) -> Vec<DVec2> {
        let mut corners: Vec<DVec2> = way.iter().map(|&index| self.point(index)).collect();
        loop {
            let mut kept: Vec<DVec2> = corners.iter().take(1).copied().collect();
            for (i, corner) in corners.iter().enumerate().skip(1) {
                let is_last = i + 1 == corners.len();
                let from = kept[kept.len() - 1];
                if is_last || !self.is_free(from, corners[i + 1]) {
                    kept.push(*corner);
                }
            }
            if kept.len() == corners.len() {
                return kept;
            }
            corners = kept;
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sim::CourseKind;

    fn way_m(kind: &str, radius_m: f64) -> Option<f64> {
        kind.parse::<CourseKind>().unwrap().course(3).unwrap().shortest_way_m(radius_m)
    }

    #[test]
    fn without_obstacles_it_is_straight() {
        let found = way_m("forest:density=1/10000:length=100:free=500", 0.6).unwrap();
        // To the next place of the grid behind the goal.
        assert!((found - 100.0).abs() <= 0.5, "{found}");
    }

    /// Around the end of a wall: two straight lines, and an arc of the radius about its edge.
    #[test]
    fn around_a_wall_it_is_that_of_geometry() {
        let (radius, half, before) = (0.6, 20.0, 40.0_f64);
        let found = way_m("wall:distance=40:width=40:incidence=0:offset=0:past=40", radius).unwrap();
        let to_edge_m = before.hypot(half);
        let tangent_m = (to_edge_m * to_edge_m - radius * radius).sqrt();
        let arc_m = radius * ((half / before).atan() + (radius / to_edge_m).asin());
        let expected = tangent_m + arc_m + 40.0;
        // Places of 0.5 m: up to two more of them around the edge.
        assert!(found >= expected - 1e-9 && found <= expected + 1.0, "{found} {expected}");
    }

    #[test]
    fn where_no_way_leads_there_is_none() {
        assert_eq!(way_m("wall:distance=40:width=400:incidence=0:offset=0", 0.6), None);
        assert!(way_m("poisson-forest:density=1/25", 0.1).is_some());
        assert_eq!(way_m("poisson-forest:density=1/25", 4.0), None);
    }

    /// All that is left of a way is free.
    #[test]
    fn ways_are_free() {
        for seed in 0..3 {
            let course = "forest:density=1/40".parse::<CourseKind>().unwrap().course(seed).unwrap();
            let search = Search::new(&course, 0.6);
            let corners = search.cut(&search.way().unwrap());
            assert!(corners.windows(2).all(|ends| search.is_free(ends[0], ends[1])));
            let length_m = course.shortest_way_m(0.6).unwrap();
            assert!(length_m >= course.length_m && length_m <= 1.05 * course.length_m, "{length_m}");
        }
    }
}
