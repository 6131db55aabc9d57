//! The selection of corners among the local maxima of the response.

use super::{Corner, CornerParameters};
use crate::frame::Plane;

/// A selection of the strongest corners that keep their distance from each other and from points that are there already.
pub(crate) struct Select<'a> {
    pub(crate) parameters: &'a CornerParameters,
    /// Points that corners keep their distance from, in pixels.
    pub(crate) occupied: &'a [[f32; 2]],
    /// The most corners; `None` for no limit.
    pub(crate) limit: Option<usize>,
}

impl Select<'_> {
    /// The corners, strongest first; of equal ones the one further down, then further right. `maxima` holds the response at
    /// local maxima and 0 elsewhere, `largest` is the response's largest value.
    pub(crate) fn corners(&self, maxima: &Plane, largest: f32) -> Vec<Corner> {
        let threshold = (f64::from(largest) * self.parameters.quality_level) as f32;
        let strong = |(_, response): &(usize, &f32)| **response > threshold && **response > 0.0;
        let mut candidates: Vec<(usize, f32)> =
            maxima.data.iter().enumerate().filter(strong).map(|(i, response)| (i, *response)).collect();
        candidates.sort_unstable_by(|(i, a), (j, b)| b.total_cmp(a).then(j.cmp(i)));
        let width = maxima.size.width as usize;
        let mut grid = Grid::new(self.parameters.min_distance);
        self.occupied.iter().for_each(|point| grid.add(*point));
        let mut corners = Vec::new();
        for (i, response) in candidates {
            if self.limit.is_some_and(|limit| corners.len() >= limit) {
                break;
            }
            let place = [(i % width) as f32, (i / width) as f32];
            if grid.is_free(place) {
                grid.add(place);
                corners.push(Corner { x: place[0], y: place[1], response });
            }
        }
        corners
    }
}

/// Points by cells as wide as the least distance, so that only neighbouring cells are searched.
struct Grid {
    distance: f64,
    cells: std::collections::HashMap<[i64; 2], Vec<[f32; 2]>>,
}

impl Grid {
    fn new(distance: f64) -> Self {
        Self { distance, cells: std::collections::HashMap::new() }
    }

    fn cell(&self, place: [f32; 2]) -> [i64; 2] {
        place.map(|side| (f64::from(side) / self.distance).floor() as i64)
    }

    fn add(&mut self, place: [f32; 2]) {
        if self.distance >= 1.0 {
            let cell = self.cell(place);
            self.cells.entry(cell).or_default().push(place);
        }
    }

    fn is_free(&self, place: [f32; 2]) -> bool {
        if self.distance < 1.0 {
            return true;
        }
        let [column, row] = self.cell(place);
        let near = |other: &[f32; 2]| {
            let [dx, dy] = [place[0] - other[0], place[1] - other[1]];
            f64::from(dx * dx + dy * dy) < self.distance * self.distance
        };
        let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| [column + i, row + j]));
        !around.filter_map(|cell| self.cells.get(&cell)).flatten().any(near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Size;

    fn selected(parameters: CornerParameters, occupied: &[[f32; 2]], limit: Option<usize>) -> Vec<[f32; 2]> {
        let size = Size::new(20, 10);
        let mut data = vec![0.0; size.pixels()];
        for (x, y, response) in [(3, 3, 1.0), (5, 3, 0.9), (12, 4, 0.9), (16, 8, 0.05), (1, 8, -2.0)] {
            data[y * 20 + x] = response;
        }
        let select = Select { parameters: &parameters, occupied, limit };
        select.corners(&Plane { size, data }, 1.0).iter().map(|corner| [corner.x, corner.y]).collect()
    }

    #[test]
    fn corners_are_strong_and_apart() {
        let parameters = |quality_level, min_distance| CornerParameters {
            quality_level,
            min_distance,
            ..CornerParameters::default()
        };
        // Of two equal ones, the one further down is first.
        assert_eq!(selected(parameters(0.1, 0.0), &[], None), [[3.0, 3.0], [12.0, 4.0], [5.0, 3.0]]);
        assert_eq!(selected(parameters(0.01, 2.5), &[], None), [[3.0, 3.0], [12.0, 4.0], [16.0, 8.0]]);
        // A distance of exactly the least one is enough.
        assert_eq!(selected(parameters(0.1, 2.0), &[], None).len(), 3);
        assert_eq!(selected(parameters(0.1, 0.0), &[], Some(1)), [[3.0, 3.0]]);
        assert_eq!(selected(parameters(0.1, 3.0), &[[2.5, 3.0]], None), [[12.0, 4.0]]);
        // The threshold itself is not enough.
        assert_eq!(selected(parameters(0.9, 0.0), &[], None).len(), 1);
    }
}
