//! Edges of motion and depth, and thin things between them.

use crate::frame::{FlowField, Plane, Size};

/// How near a motion edge is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Near {
    Within3,
    Within10,
    Beyond,
}

/// The flow of neighbours differs by over this many pixels and [`SHARE`] of the longer displacement.
const APART_PX: f32 = 0.5;
const SHARE: f32 = 0.05;
/// Depths beside an edge have a ratio over this.
const RATIO: f32 = 1.3;
/// The widths of thin things, in pixels along the row.
const THIN: std::ops::RangeInclusive<usize> = 2..=6;
/// The depth that stands for none.
const FAR_M: f32 = 1e4;
/// The distances from an edge beyond which classes begin, in pixels.
const REACH: [i64; 2] = [3, 10];

/// How near each pixel is to a motion edge. Unknown flow has no edges.
pub(super) fn motion_edges(flow: &FlowField) -> Vec<Near> {
    let (width, height) = (flow.size.width as usize, flow.size.height as usize);
    let mut beside = vec![false; flow.data.len()];
    let mut mark = |i: usize, j: usize| {
        if apart(flow.data[i], flow.data[j], SHARE) {
            (beside[i], beside[j]) = (true, true);
        }
    };
    for i in 0..flow.data.len() {
        if (i + 1) % width != 0 {
            mark(i, i + 1);
        }
        if i / width + 1 < height {
            mark(i, i + width);
        }
    }
    let squared = squared_distances(&beside, flow.size);
    let [near, far] = REACH.map(|reach| reach * reach);
    let class = |squared: i64| match squared {
        _ if squared < near => Near::Within3,
        _ if squared < far => Near::Within10,
        _ => Near::Beyond,
    };
    squared.into_iter().map(class).collect()
}

/// Whether two displacements are known and differ.
fn apart(a: [f32; 2], b: [f32; 2], share: f32) -> bool {
    let longer = a[0].hypot(a[1]).max(b[0].hypot(b[1]));
    FlowField::is_known(a)
        && FlowField::is_known(b)
        && (a[0] - b[0]).hypot(a[1] - b[1]) > APART_PX + share * longer
}

/// The squared distance of each pixel from the nearest marked one, or any value from the square of the longest reach on.
fn squared_distances(marked: &[bool], size: Size) -> Vec<i64> {
    let (width, height) = (size.width as usize, size.height as usize);
    let reach = REACH[1];
    let mut along = vec![reach; marked.len()];
    for (row, marked) in along.chunks_exact_mut(width).zip(marked.chunks_exact(width)) {
        let mut pass = |x: usize, from: &mut i64| {
            *from = if marked[x] { 0 } else { (*from + 1).min(reach) };
            row[x] = row[x].min(*from);
        };
        let mut from = reach;
        (0..width).for_each(|x| pass(x, &mut from));
        from = reach;
        (0..width).rev().for_each(|x| pass(x, &mut from));
    }
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(reach as usize)..(y + reach as usize + 1).min(height);
        let squared = |row: usize| (row as i64 - y as i64).pow(2) + along[row * width + x].pow(2);
        rows.map(squared).min().unwrap_or(reach * reach)
    };
    (0..marked.len()).map(at).collect()
}

/// Whether each pixel is within 3 px along the row of a depth edge.
pub(super) fn depth_edges(depth_m: &Plane) -> Vec<bool> {
    let width = depth_m.size.width as usize;
    let mut near = vec![false; depth_m.data.len()];
    for (row, near) in depth_m.data.chunks_exact(width).zip(near.chunks_exact_mut(width)) {
        for x in jumps(row) {
            let reach = REACH[0] as usize;
            near[(x + 1).saturating_sub(reach)..(x + 1 + reach).min(width)].fill(true);
        }
    }
    near
}

/// Whether each pixel is inside a thin thing.
pub(super) fn thin_things(depth_m: &Plane, flow: &FlowField) -> Vec<bool> {
    let width = depth_m.size.width as usize;
    let mut thin = vec![false; depth_m.data.len()];
    let rows = depth_m.data.chunks_exact(width).zip(flow.data.chunks_exact(width));
    for ((row, flow), thin) in rows.zip(thin.chunks_exact_mut(width)) {
        let is_behind = |outer: usize, inner: usize| distance(row[outer]) > RATIO * distance(row[inner]);
        // What is unknown moves otherwise.
        let differs = |i: usize, j: usize| {
            !FlowField::is_known(flow[i]) || !FlowField::is_known(flow[j]) || apart(flow[i], flow[j], 0.0)
        };
        for ends in jumps(row).windows(2) {
            let [first, last] = [ends[0] + 1, ends[1]];
            let middle = (first + last) / 2;
            let sides = [(first - 1, first), (last + 1, last)];
            let is_thin = THIN.contains(&(last - first + 1))
                && sides.iter().all(|&(outer, inner)| is_behind(outer, inner) && differs(middle, outer));
            if is_thin {
                thin[first..=last].fill(true);
            }
        }
    }
    thin
}

/// The columns after which the depth of a row jumps.
fn jumps(row: &[f32]) -> Vec<usize> {
    let jump = |pair: &[f32]| {
        let ratio = distance(pair[1]) / distance(pair[0]);
        ratio > RATIO || ratio < RATIO.recip()
    };
    row.windows(2).enumerate().filter(|(_, pair)| jump(pair)).map(|(x, _)| x).collect()
}

/// A depth as a positive number: the sky and what is unknown are far away.
fn distance(depth_m: f32) -> f32 {
    if depth_m.is_finite() && depth_m > 0.0 { depth_m } else { FAR_M }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(data: &[f32]) -> Plane {
        Plane { size: Size::new(data.len() as u32, 1), data: data.to_vec() }
    }

    fn row(flow: Vec<[f32; 2]>) -> FlowField {
        FlowField { size: Size::new(flow.len() as u32, 1), data: flow }
    }

    fn text(flags: &[bool]) -> String {
        flags.iter().map(|flag| if *flag { '#' } else { '.' }).collect()
    }

    #[test]
    fn distances_from_an_edge_are_euclidean() {
        let size = Size::new(31, 31);
        let mut marked = vec![false; size.pixels()];
        marked[15 * 31 + 15] = true;
        let squared = squared_distances(&marked, size);
        for (i, found) in squared.into_iter().enumerate() {
            let (x, y) = ((i % 31) as i64 - 15, (i / 31) as i64 - 15);
            assert_eq!(found.min(100), (x * x + y * y).min(100), "{x} {y}");
        }
    }

    #[test]
    fn a_motion_edge_has_three_classes_on_each_side() {
        let flow = (0..30).map(|x| if x < 15 { [0.0; 2] } else { [2.0, 0.0] }).collect();
        let near = motion_edges(&row(flow));
        let letter = |near: &Near| match near {
            Near::Within3 => '3',
            Near::Within10 => 'n',
            Near::Beyond => '.',
        };
        assert_eq!(near.iter().map(letter).collect::<String>(), ".....nnnnnnn333333nnnnnnn.....");
    }

    #[test]
    fn a_ramp_and_unknown_flow_are_no_edges() {
        // 1 px per pixel is under ½ px and 5 % from 10 px on.
        let ramp = row((0..40).map(|x| [10.0 + x as f32, 0.0]).collect());
        assert!(motion_edges(&ramp).iter().all(|near| *near == Near::Beyond));
        let unknown = row(vec![[0.0; 2], [f32::NAN; 2], [9.0, 0.0]]);
        assert!(motion_edges(&unknown).iter().all(|near| *near == Near::Beyond));
    }

    #[test]
    fn three_pixels_on_both_sides_of_a_jump_in_depth() {
        let depth = plane(&[9.0, 9.0, 9.0, 9.0, 9.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.1, 6.0]);
        assert_eq!(text(&depth_edges(&depth)), "..######....");
        assert_eq!(text(&depth_edges(&plane(&[1.0, f32::INFINITY]))), "##");
        assert_eq!(text(&depth_edges(&plane(&[f32::NAN, f32::INFINITY]))), "..");
    }

    #[test]
    fn thin_things_are_narrow_near_and_move_otherwise() {
        let scene = |width: usize, depth: f32, speed: f32| {
            let inside = |x: usize| (4..4 + width).contains(&x);
            let depths: Vec<f32> = (0..16).map(|x| if inside(x) { depth } else { 10.0 }).collect();
            let flow = (0..16).map(|x| if inside(x) { [speed, 0.0] } else { [0.0; 2] }).collect();
            text(&thin_things(&plane(&depths), &row(flow)))
        };
        assert_eq!(scene(2, 5.0, 1.0), "....##..........");
        assert_eq!(scene(6, 5.0, 1.0), "....######......");
        for (width, depth, speed) in
            [(1, 5.0, 1.0), (7, 5.0, 1.0), (3, 8.0, 1.0), (3, 20.0, 1.0), (3, 5.0, 0.4)]
        {
            assert_eq!(scene(width, depth, speed), "................", "{width} {depth} {speed}");
        }
    }
}
