//! Courses: for any seed they match their parameters, and they do not change.

use glam::{DVec2, DVec3};
use viewsphere::sim::course::{City, Corridor, DeadEnd, Forest, Gates, PoissonForest, Wall, Wires};
use viewsphere::sim::{Course, CourseKind, Form};

const SEEDS: u64 = 40;

/// Axes, radii and heights of the trees.
fn trunks(course: &Course) -> Vec<(DVec2, f64, f64)> {
    let trunk = |form| match form {
        Form::Cylinder { base_world, top_world, radius_m } => {
            assert_eq!((base_world.z, base_world.truncate()), (0.0, top_world.truncate()));
            Some((base_world.truncate(), radius_m, -top_world.z))
        }
        _ => None,
    };
    course.world.surfaces.iter().filter_map(|surface| trunk(surface.form())).collect()
}

/// Both ends and the height of the walls.
fn walls(course: &Course) -> Vec<(DVec2, DVec2, f64)> {
    let wall = |form| match form {
        Form::Rectangle { centre_world, to_right, to_top } => {
            assert!(to_right.z == 0.0 && to_top.truncate() == DVec2::ZERO && centre_world.z == to_top.z);
            let (centre, half) = (centre_world.truncate(), to_right.truncate());
            Some((centre - half, centre + half, -2.0 * to_top.z))
        }
        _ => None,
    };
    course.world.surfaces.iter().filter_map(|surface| wall(surface.form())).collect()
}

/// Whether a count is within five standard deviations of its expectation.
fn is_likely(found: usize, expected: f64, variance: f64) -> bool {
    (found as f64 - expected).abs() <= 5.0 * variance.sqrt()
}

#[test]
fn every_course_can_be_flown_and_is_the_same_again() {
    for kind in CourseKind::all() {
        let mut before: Option<Course> = None;
        for seed in 0..SEEDS {
            let course = kind.course(seed).unwrap();
            course.validate().unwrap();
            assert_eq!(course, kind.course(seed).unwrap());
            assert_eq!((&course.name[..], course.seed), (kind.name(), seed));
            let same = before.is_some_and(|before| before.world == course.world);
            assert!(!same, "{kind} {seed} is that of the seed before");
            let ground = Form::Plane { point_world: DVec3::ZERO, normal_world: DVec3::NEG_Z };
            assert_eq!(course.world.surfaces[0].form(), ground);
            let altitude_m = -course.start_ned_m.z;
            assert!(course.altitude_m[0] < altitude_m && altitude_m < course.altitude_m[1]);
            // The nearest surface at the start is the ground, or in a corridor a wall.
            let clearance_m = course.world.clearance_m(course.start_ned_m);
            assert!(clearance_m > 9.8, "{kind} {seed}: {clearance_m} m");
            before = Some(course);
        }
    }
}

#[test]
fn progress_is_counted_towards_the_goal_alone() {
    let mut course = CourseKind::all()[0].course(0).unwrap();
    course.start_ned_m = DVec3::new(100.0, -50.0, -10.0);
    let position = DVec3::new(103.0, -46.0, -90.0);
    for (goal_yaw_rad, expected) in [(0.0_f64, 3.0), (0.5 * std::f64::consts::PI, 4.0), (0.8_f64.asin(), 5.0)]
    {
        course.goal_yaw_rad = goal_yaw_rad;
        // Rounding of numbers near 5.
        assert!((course.progress_m(position) - expected).abs() <= 1e-14);
    }
    assert_eq!(course.offset_m(position), None);
}

#[test]
fn trees_stand_at_their_density_and_distance_and_not_at_the_start() {
    let denser = Forest { density_per_m2: 1.0 / 25.0, ..Forest::default() };
    for forest in [Forest::default(), Forest::PILLARS, denser] {
        let gap_m = 0.7 / forest.density_per_m2.sqrt();
        let (mut total, mut left) = (0, 0);
        for seed in 0..6 {
            let course = forest.course(seed).unwrap();
            let trunks = trunks(&course);
            for (i, (place, radius_m, height_m)) in trunks.iter().enumerate() {
                assert!((-20.0..=260.0).contains(&place.x) && place.y.abs() <= 80.0);
                assert!(place.length() - radius_m >= forest.free_m);
                assert!((forest.radius_m[0]..=forest.radius_m[1]).contains(radius_m));
                assert!((forest.height_m[0]..=forest.height_m[1]).contains(height_m));
                assert!(*height_m > course.altitude_m[1]);
                let nearest =
                    trunks[..i].iter().map(|other| other.0.distance(*place)).fold(f64::INFINITY, f64::min);
                assert!(nearest >= gap_m, "{nearest} of {gap_m} m");
            }
            total += trunks.len();
            left += trunks.iter().filter(|trunk| trunk.0.y < 0.0).count();
        }
        // The area without the half disc around the start. With a minimum distance between trees, the variance is
        // smaller.
        let free_m2 = std::f64::consts::PI * forest.free_m.powi(2);
        let expected = 6.0 * forest.density_per_m2 * (280.0 * 160.0 - free_m2);
        assert!(is_likely(total, expected, 6.0 * forest.density_per_m2 * free_m2), "{total} of {expected}");
        assert!(is_likely(left, total as f64 / 2.0, total as f64 / 4.0), "{left} of {total} to the left");
    }
}

#[test]
fn a_poisson_forest_has_the_counts_of_its_process() {
    for density_per_m2 in [1.0 / 49.0, 1.0 / 36.0, 1.0 / 25.0] {
        let forest = PoissonForest { density_per_m2, ..PoissonForest::default() };
        // 4 × 5 fields of 25 by 24 m; the first starts at the trees' bark.
        let (mut counts, mut rows) = (vec![], vec![]);
        for seed in 0..200 {
            let course = forest.course(seed).unwrap();
            assert_eq!(course.length_m, 65.0);
            let mut fields = [[0_usize; 5]; 4];
            for (place, radius_m, _) in trunks(&course) {
                assert!(place.x - radius_m >= 25.0 && radius_m == 0.3 && place.y.abs() <= 60.0);
                let [row, column] =
                    [(place.x - 25.0) / 25.0, (place.y + 60.0) / 24.0].map(|field| field as usize);
                fields[row.min(3)][column.min(4)] += 1;
            }
            counts.extend(fields.into_iter().flatten());
            rows.extend(fields.map(|row| row.into_iter().sum::<usize>()));
        }
        for (counts, width_m) in [(counts, 24.0), (rows, 120.0)] {
            let n = counts.len() as f64;
            // 0.3 m of 100 are missing from the first row.
            let mean = density_per_m2 * width_m * (100.0 - 0.3) / 4.0;
            let total: usize = counts.iter().sum();
            assert!(is_likely(total, n * mean, n * mean), "{total} trees, expected {}", n * mean);
            // The variance is the mean, with its own of (mean + 2 mean²)/n.
            let variance = counts.iter().map(|count| (*count as f64 - mean).powi(2)).sum::<f64>() / n;
            let bound = 5.0 * ((mean + 2.0 * mean * mean) / n).sqrt();
            assert!((variance - mean).abs() <= bound, "variance {variance}, mean {mean}, bound {bound}");
        }
    }
}

#[test]
fn houses_stand_apart_and_within_their_ranges() {
    let city = City::default();
    let mut houses = 0;
    for seed in 0..SEEDS {
        let course = city.course(seed).unwrap();
        let mut places: Vec<DVec2> = vec![];
        for surface in &course.world.surfaces[1..] {
            let Form::Cuboid { centre_world, edges_m, .. } = surface.form() else { panic!("{surface:?}") };
            assert!([edges_m.x, edges_m.y].iter().all(|edge| (10.0..=24.0).contains(edge)));
            assert!((12.0..=60.0).contains(&edges_m.z) && centre_world.z == -edges_m.z / 2.0);
            assert!(surface.distance_m(DVec3::ZERO) >= city.free_m);
            assert!(places.iter().all(|place| place.distance(centre_world.truncate()) >= 0.7 * 48.0));
            places.push(centre_world.truncate());
        }
        houses += places.len();
        assert!(course.altitude_m[1] > 60.0, "to climb over is allowed");
    }
    // 54 in 520 by 240 m, less those of the free disc and of the border to which their edges reach.
    let mean = houses as f64 / SEEDS as f64;
    assert!((47.0..54.0).contains(&mean), "{mean} houses");
}

#[test]
fn a_wall_stands_where_it_should_and_ends_before_the_course_does() {
    let wall = Wall::default();
    for seed in 0..200 {
        let course = wall.course(seed).unwrap();
        let [(from, to, height_m)] = walls(&course)[..] else { panic!("not one wall") };
        let (middle, along) = (from.midpoint(to), to - from);
        assert!((80.0..=100.0).contains(&middle.x) && middle.y.abs() <= 20.0 && height_m == 40.0);
        assert!((39.999..=70.001).contains(&along.length()));
        assert!(along.x.abs() <= along.y * (1.0 + 1e-9) && along.y > 0.0);
        // 20 m remain from its further end.
        assert!((course.length_m - from.x.max(to.x) - 20.0).abs() <= 1e-9);
        assert!(course.altitude_m[1] < height_m);
    }
    let turned = Wall { incidence_deg: [30.0; 2], offset_m: [0.0; 2], ..wall }.course(1).unwrap();
    let (from, to, _) = walls(&turned)[0];
    assert!(to.y > 0.0 && to.x > from.x, "the right end is farther away: {from} {to}");
}

#[test]
fn no_ray_leaves_a_corridor_to_the_side() {
    for width_m in [14.0, 20.0, 30.0] {
        let corridor = Corridor { width_m, ..Corridor::default() };
        for seed in 0..4 {
            let course = corridor.course(seed).unwrap();
            let line = &course.centre_line_m;
            // The ends are open, and oblique.
            let closed_m = -20.0..350.0;
            let stays = |eye: DVec3, direction: DVec3, far_m: f64| {
                let hit = course.world.hit(eye, direction);
                let far_m = hit.map_or(far_m, |hit| hit.distance_m.min(far_m));
                let places = (1..=20).map(|step| eye + direction * (far_m * f64::from(step) / 20.0));
                // The chords of walls and centre line deviate from their curves by 0.12 m at most.
                let inside = |place: DVec3| course.offset_m(place).unwrap().abs() <= width_m / 2.0 + 0.2;
                places.take_while(|place| closed_m.contains(&place.x)).all(inside)
            };
            let on_the_way = |point: &&DVec2| (0.0..=course.length_m).contains(&point.x);
            for point in line.iter().filter(on_the_way).step_by(3) {
                let eye = point.extend(-10.0);
                for step in 0..180 {
                    let direction = DVec2::from_angle(f64::from(2 * step).to_radians()).extend(0.0);
                    assert!(stays(eye, direction, 5.0 * width_m), "{seed}: from {eye} to {direction}");
                }
                // At the joints of links.
                for (joint, _, _) in walls(&course) {
                    let to_joint = joint.extend(-10.0) - eye;
                    if to_joint.length() < 2.0 * width_m {
                        let far_m = to_joint.length() + 5.0;
                        assert!(stays(eye, to_joint.normalize(), far_m), "{seed}: from {eye} past {joint}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_corridor_is_as_wide_and_as_bent_as_it_should_be_and_knows_its_middle() {
    let mut sharpest = 0.0_f64;
    for seed in 0..SEEDS {
        let course = Corridor::default().course(seed).unwrap();
        let line = &course.centre_line_m;
        assert!(line[0].x <= -30.0 && line[line.len() - 1].x >= 360.0);
        for places in line.windows(3) {
            let [a, b, c] = [places[1] - places[0], places[2] - places[1], places[2] - places[0]];
            // The curvature: the inverse radius of the circle through three points.
            let curvature = 2.0 * a.perp_dot(b).abs() / (a.length() * b.length() * c.length());
            assert!(curvature <= 1.0 / 35.0, "{curvature}");
            sharpest = sharpest.max(curvature);
            let right = c.normalize().perp();
            let clearance_m = course.world.clearance_m(places[1].extend(-15.0));
            // A chord of 4.8 m deviates from a radius of 25 m by 0.12 m.
            assert!((9.85..=10.0001).contains(&clearance_m), "{clearance_m}");
            for offset_m in [-9.0, -0.5, 0.5, 9.0] {
                let found = course.offset_m((places[1] + right * offset_m).extend(-3.0)).unwrap();
                assert!((found - offset_m).abs() <= 0.06, "{found} at {offset_m}");
            }
        }
        let ahead = DVec2::from_angle(course.start_yaw_rad).extend(0.0);
        let offset_m = course.offset_m(course.start_ned_m + ahead * 3.0).unwrap();
        assert!(offset_m.abs() <= 0.2, "the flight begins along the way, not {offset_m} m beside it");
    }
    assert!(sharpest > 0.9 / 35.0, "the sharpest bend has a radius of {} m", 1.0 / sharpest);
}

#[test]
fn a_dead_end_is_closed() {
    for seed in 0..SEEDS {
        let course = DeadEnd::default().course(seed).unwrap();
        let walls = walls(&course);
        let [left, end, right] = &walls[..] else { panic!("{} walls", walls.len()) };
        assert!(left.0.y < right.1.y && end.0.x == end.1.x && course.length_m == end.0.x + 20.0);
        let inside = (end.0 + end.1) / 2.0 - DVec2::X * 10.0;
        for step in -90..=90 {
            let direction = DVec2::from_angle(f64::from(step).to_radians()).extend(0.0);
            let hit = course.world.hit(inside.extend(-10.0), direction);
            assert!(hit.is_some_and(|hit| hit.distance_m < 45.0), "{seed}: {hit:?} at {step}°");
        }
        let mouth = course.world.hit(DVec3::new(0.0, 0.0, -10.0), DVec3::X).unwrap();
        assert_eq!(mouth.surface, 2, "the way leads into the trap");
    }
}

#[test]
fn wires_cross_the_way_and_leave_room_above_and_below() {
    for seed in 0..SEEDS {
        let course = Wires::default().course(seed).unwrap();
        let mut wires = 0;
        for surface in &course.world.surfaces[1..] {
            let Form::Cylinder { base_world, top_world, radius_m } = surface.form() else {
                panic!("{surface:?}")
            };
            let height_m = -top_world.z;
            assert!((50.0..200.0).contains(&base_world.x) && height_m < 12.1);
            if base_world.y == top_world.y {
                assert!(base_world.y.abs() >= 25.0 && base_world.z == 0.0, "a pole in the way");
                continue;
            }
            wires += 1;
            assert!(
                (8.0..=12.0).contains(&height_m)
                    && base_world.z == top_world.z
                    && base_world.x == top_world.x
            );
            assert!((base_world.y, top_world.y) == (-75.0, 75.0) && (0.005..=0.015).contains(&radius_m));
        }
        assert!((6..=9).contains(&wires), "{wires} wires");
        for altitude_m in [4.0, 16.0] {
            let least =
                (0..200).map(|x| course.world.clearance_m(DVec3::new(f64::from(x), 0.0, -altitude_m)));
            assert!(least.fold(f64::INFINITY, f64::min) > 3.9);
        }
    }
}

#[test]
fn gates_open_under_their_beams() {
    for seed in 0..SEEDS {
        let course = Gates::default().course(seed).unwrap();
        assert_eq!((course.world.surfaces.len() - 1) % 3, 0);
        for gate in course.world.surfaces[1..].chunks(3) {
            let [left, right, beam] = gate else { unreachable!() };
            let Form::Rectangle { centre_world, to_right, to_top } = beam.form() else { panic!("{beam:?}") };
            let bottom_m = -(centre_world.z - to_top.z);
            assert!((14.0..=16.0).contains(&bottom_m) && (4.0..=6.0).contains(&to_right.y), "{bottom_m}");
            // In the middle of the opening a wall is as far as half its width.
            let middle = centre_world.with_z(-8.0);
            for side in [left, right] {
                assert!((side.distance_m(middle) - to_right.y).abs() < 1e-9);
            }
            assert!(
                course.world.hit(middle - DVec3::X * 5.0, DVec3::X).is_none_or(|hit| hit.distance_m > 40.0)
            );
        }
    }
}

#[test]
fn trees_lean_and_have_crowns() {
    let forest = Forest { lean_deg: [5.0, 15.0], crown_m: [1.0, 2.0], ..Forest::default() };
    let plain = trunks(&Forest::default().course(3).unwrap());
    let course = forest.course(3).unwrap();
    let trees = course.world.surfaces[1..].chunks(2);
    assert_eq!(trees.len(), plain.len(), "the same trees stand at the same places");
    for (tree, (place, radius, height)) in trees.zip(plain) {
        let [
            Form::Cylinder { base_world, top_world, radius_m },
            Form::Cylinder { base_world: from, top_world: to, radius_m: crown_m },
        ] = [tree[0].form(), tree[1].form()]
        else {
            panic!("{tree:?}")
        };
        assert_eq!((base_world.truncate(), radius_m, -top_world.z), (place, radius, height));
        let lean_deg = (base_world.truncate().distance(top_world.truncate()) / height).atan().to_degrees();
        assert!((5.0..=15.0).contains(&lean_deg) && (1.0..=2.0).contains(&crown_m));
        assert!(
            from.truncate() == to.truncate() && to.z == top_world.z && (from.z + 0.6 * height).abs() < 1e-9
        );
    }
}

#[test]
fn what_is_skipped_as_too_far_is_never_the_nearest() {
    for kind in CourseKind::all() {
        let course = kind.course(1).unwrap();
        for i in 0..500 {
            let i = f64::from(i);
            // Some are below the ground, and some in a house or tree.
            let place =
                DVec3::new(i * 0.7 - 30.0, 60.0 * (i * 0.7).sin(), -40.0 * (i * 0.3).sin().abs() + 2.0);
            let all = course.world.surfaces.iter().map(|surface| surface.distance_m(place));
            assert_eq!(course.world.clearance_m(place), all.fold(f64::INFINITY, f64::min), "{kind} {place}");
        }
    }
}

/// A change of a generator invalidates what was measured in its worlds, so it must be deliberate.
#[test]
fn the_courses_of_a_seed_stay_what_they_are() {
    let sums: Vec<String> = CourseKind::all()
        .iter()
        .map(|kind| {
            let course = kind.course(7).unwrap();
            let clearances = (0..20).map(|i| {
                let place = DVec3::new(12.0 * f64::from(i), 7.0 * f64::from(i % 5) - 14.0, -10.0);
                course.world.clearance_m(place)
            });
            // Sines differ between machines in the last bit.
            let sum: f64 = clearances.sum();
            format!("{kind} {} {:.6} {sum:.6}", course.world.surfaces.len(), course.length_m)
        })
        .collect();
    let expected = [
        "wall 2 119.719887 182.272845",
        "corridor 197 300.000000 109.465947",
        "city 50 400.000000 165.038551",
        "forest 433 200.000000 94.052509",
        "pillars 219 200.000000 99.672129",
        "poisson-forest 247 65.000000 141.528606",
        "dead-end 4 145.811809 168.437428",
        "wires 22 200.000000 175.981698",
        "gates 10 200.000000 176.216888",
    ];
    assert_eq!(sums, expected);
}
