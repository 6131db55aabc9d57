use std::time::Duration;

use super::*;
use crate::camera::Lens;
use crate::frame::{Size, UNKNOWN_FLOW};
use crate::pipeline::Invalid;
use crate::sphere::{Heading, Sectors};

const SIZE: Size = Size::new(200, 150);
const GRAY: [u8; 3] = [90; 3];

fn camera() -> Camera {
    Camera { size: SIZE, f_u: 100.0, f_v: 100.0, u_0: 99.5, v_0: 74.5, lens: Lens::NONE }
}

fn cue<'a>(sectors: &'a Sectors, flow: &'a FlowField) -> Cue<'a> {
    Cue {
        frame: 1,
        time_s: 0.5,
        interval_s: Some(0.1),
        invalid: None,
        prev_from_cur: None,
        residual_rotation_rad_s: None,
        heading: Heading::UNKNOWN,
        sectors,
        threat: None,
        flow: Some(flow),
        looming: None,
        cells: None,
        spherical_flow: None,
        latency: Duration::ZERO,
    }
}

fn drawn(change: impl FnOnce(&mut Cue<'_>), uv: [f32; 2]) -> Vec<[u8; 3]> {
    let camera = camera();
    let mut sectors = Sectors::unknown(Grid::over(&camera, [4, 3]).unwrap());
    sectors.interval_s = 0.1;
    (sectors.sectors[0].coverage, sectors.sectors[0].nearness_rate_hz) = (1.0, [2.0; 3]);
    let flow = FlowField { size: SIZE, data: vec![uv; SIZE.pixels()] };
    let mut cue = cue(&sectors, &flow);
    change(&mut cue);
    let gray = vec![90; SIZE.pixels()];
    let frame = Frame::new(SIZE, PixelFormat::Gray8, &gray).unwrap();
    let mut overlay = Overlay::new(&camera, &camera).unwrap();
    overlay.draw(&frame, &cue).unwrap().data.as_chunks::<3>().0.to_vec()
}

fn at(image: &[[u8; 3]], x: usize, y: usize) -> [u8; 3] {
    image[y * SIZE.width as usize + x]
}

#[test]
fn a_sector_that_is_met_soon_is_framed_in_red_and_others_are_dark() {
    let image = drawn(|_| {}, [UNKNOWN_FLOW; 2]);
    let grid = Grid::over(&camera(), [4, 3]).unwrap();
    let right = grid.azimuth_rad[0] + grid.pitch_rad()[0];
    let right = (100.0 * right.tan() + 99.5).floor() as usize;
    assert!(at(&image, right, 20)[0] > 200 && at(&image, right, 20)[1] < 60, "{:?}", at(&image, right, 20));
    let beside = at(&image, right + 1, 20);
    assert!(beside[0] < 90 && beside[0] == beside[1], "{beside:?}");
    // Without motion and nearness the centre of a sector stays gray.
    assert_eq!((at(&image, right / 2, 15), at(&image, 90, 60)), (GRAY, GRAY));
}

#[test]
fn layers_show_the_flow_or_the_sectors() {
    let camera = camera();
    let mut sectors = Sectors::unknown(Grid::over(&camera, [4, 3]).unwrap());
    sectors.interval_s = 0.1;
    (sectors.sectors[0].coverage, sectors.sectors[0].nearness_rate_hz) = (1.0, [2.0; 3]);
    let flow = FlowField { size: SIZE, data: vec![[-2.0, 0.0]; SIZE.pixels()] };
    let gray = vec![90; SIZE.pixels()];
    let frame = Frame::new(SIZE, PixelFormat::Gray8, &gray).unwrap();
    let mut overlay = Overlay::new(&camera, &camera).unwrap();
    let mut shown = |layers| {
        let image = overlay.draw_layers(&frame, &cue(&sectors, &flow), layers).unwrap();
        let image = image.data.as_chunks::<3>().0.to_vec();
        [at(&image, 20, 20), at(&image, 120, 120)]
    };
    // Motion to the right is red, and so is a contact within a second: the sector at the upper left.
    let [[r, g, _], elsewhere] = shown(Layers::Flow);
    assert!(r > 150 && g < 80 && elsewhere == [r, g, elsewhere[2]], "{r} {g} {elsewhere:?}");
    let [[r, g, b], elsewhere] = shown(Layers::Sectors);
    assert!(r > 150 && g == b && g < 80 && elsewhere == GRAY, "{r} {g} {b} {elsewhere:?}");
}

#[test]
fn the_flow_is_shown_from_the_frame_before() {
    // The flow points back to the left: the motion is to the right, which is red.
    let image = drawn(|_| {}, [-2.0, 0.0]);
    let [r, g, b] = at(&image, 90, 60);
    assert!(r > 150 && g < 80 && b < 90, "{r} {g} {b}");
    assert_eq!(at(&drawn(|_| {}, [0.0; 2]), 90, 60), GRAY);
}

#[test]
fn a_threat_is_boxed_and_the_heading_crossed() {
    let threat = Threat { azimuth_rad: 0.0, elevation_rad: 0.0, time_s: 1.3, sectors: 1, alarm: true };
    let heading = Heading { direction: DVec3::new(0.2, 0.1, 1.0).normalize(), error_rad: 0.1 };
    let image = drawn(|cue| (cue.threat, cue.heading) = (Some(threat), heading), [UNKNOWN_FLOW; 2]);
    // The direction's pixel is 99.5 + 20, 74.5 + 10.
    assert_eq!(at(&image, 120, 85), HEADING);
    let box_left = 99.5 - 100.0 * (0.5 * camera_pitch()).tan();
    let left = at(&image, box_left.round() as usize, 75);
    assert_eq!(left, TIMES[0].1, "{box_left}");
}

fn camera_pitch() -> f64 {
    Grid::over(&camera(), [4, 3]).unwrap().pitch_rad()[0]
}

#[test]
fn the_horizon_is_where_the_camera_is_level() {
    let row = |up: Option<DVec3>, x: usize| {
        let gray = vec![90; SIZE.pixels()];
        let frame = Frame::new(SIZE, PixelFormat::Gray8, &gray).unwrap();
        let sectors = Sectors::unknown(Grid::over(&camera(), [4, 3]).unwrap());
        let flow = FlowField { size: SIZE, data: vec![[UNKNOWN_FLOW; 2]; SIZE.pixels()] };
        let mut overlay = Overlay::new(&camera(), &camera()).unwrap();
        overlay.set_up(up);
        let image = overlay.draw(&frame, &cue(&sectors, &flow)).unwrap();
        let image = image.data.as_chunks::<3>().0.to_vec();
        (0..150).find(|y| at(&image, x, *y) == HORIZON)
    };
    assert_eq!(row(None, 100), None);
    // The nose is up by atan 0.2, which lowers the horizon by 20 px; right above nothing is level.
    assert_eq!(row(Some(DVec3::new(0.0, -1.0, 0.2)), 100), Some(95));
    assert_eq!(row(Some(DVec3::NEG_Z), 100), None);
    // The right wing is down, and the horizon rises to the right: by 45 degrees here.
    let up = Some(DVec3::new(-1.0, -1.0, 0.0));
    assert_eq!([60, 140].map(|x| row(up, x)), [Some(114), Some(34)]);
    // The left wing points straight down.
    assert_eq!([99, 20].map(|x| row(Some(DVec3::X), x)), [None, None]);
    assert_eq!(row(Some(DVec3::X), 100), Some(0));
}

#[test]
fn an_invalid_cue_has_a_border_and_nothing_else() {
    let image = drawn(|cue| cue.invalid = Some(Invalid::First), [-2.0, 0.0]);
    assert_eq!((at(&image, 0, 0), at(&image, 199, 70), at(&image, 90, 60)), (INVALID, INVALID, GRAY));
}
