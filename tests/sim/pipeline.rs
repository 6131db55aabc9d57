//! The pipeline: both backends agree, and every invalid cue has a reason.

use glam::DVec3;
use viewsphere::camera::{Camera, Lens};
use viewsphere::frame::{Image, Plane, Size};
use viewsphere::imu::{GyroConfig, GyroSample};
use viewsphere::pipeline::Invalid;
use viewsphere::sim::{RayTable, reference_render, scenes};
use viewsphere::sphere::{Derotation, ExtraOutputs, Heading, Sectors, Sphere};
use viewsphere::{Backend, Error, Pipeline, PipelineConfig};

use crate::need;
use crate::straight::{FlightPath, camera};

const FLIGHT: FlightPath = FlightPath {
    start_world: DVec3::ZERO,
    velocity_world: DVec3::new(0.5, 0.0, 10.0),
    omega_rad_s: DVec3::new(0.1, -0.3, 0.8),
};

fn good<T>(result: viewsphere::Result<T>) -> T {
    result.unwrap_or_else(|error| panic!("{error}"))
}

/// A camera of a quarter of the pixels, for speed.
fn small() -> Camera {
    camera().resized(Size::new(320, 240))
}

fn frames(camera: &Camera, count: usize) -> Vec<(f64, Image)> {
    let world = good(scenes::yard(9.0));
    let rays = good(RayTable::new(camera));
    let time_s = |i: usize| 0.1 + i as f64 / 30.0;
    (0..count).map(|i| (time_s(i), reference_render(&world, &rays, &FLIGHT.pose(time_s(i))).image)).collect()
}

fn with_gyro() -> PipelineConfig {
    PipelineConfig { gyro: Some(GyroConfig::default()), ..PipelineConfig::default() }
}

/// Samples that cover one second, except those that `keep` rejects.
fn gyro(pipeline: &mut Pipeline, keep: impl Fn(f64) -> bool) {
    for i in 0..200 {
        let time_s = f64::from(i) * 0.005;
        if keep(time_s) {
            pipeline.push_gyro(GyroSample { time_s, gyro_rad_s: FLIGHT.omega_rad_s });
        }
    }
}

/// The sectors of every frame but the first, and the reasons of all.
fn run(
    backend: Backend,
    camera: &Camera,
    config: &PipelineConfig,
) -> Vec<(Option<Invalid>, Sectors, Heading)> {
    let mut pipeline = good(Pipeline::new(backend, camera, config));
    gyro(&mut pipeline, |_| true);
    let mut cues = Vec::new();
    for (time_s, image) in frames(camera, 4) {
        let cue = good(pipeline.process(&good(image.frame()), time_s));
        cues.push((cue.invalid, cue.sectors.clone(), cue.heading));
    }
    cues
}

#[test]
fn both_executors_say_the_same() {
    let Some(gpu) = need::gpu() else { return };
    for derotation in [Derotation::Before, Derotation::After, Derotation::Primed] {
        let mut config = with_gyro();
        config.sphere = Sphere { derotation, ..Sphere::default() };
        config.certainty = derotation == Derotation::Before;
        let [on_gpu, on_cpu] = [Backend::Gpu(gpu.clone()), Backend::Cpu].map(|b| run(b, &small(), &config));
        assert!(on_cpu[1..].iter().all(|(invalid, ..)| invalid.is_none()), "{derotation:?}");
        for ((invalid, found, heading), (cpu_invalid, expected, cpu_heading)) in on_gpu.iter().zip(&on_cpu) {
            assert_eq!(invalid, cpu_invalid);
            assert!(heading.direction.angle_between(cpu_heading.direction) < 1e-3);
            let mut compared = 0;
            for (found, expected) in found.sectors.iter().zip(&expected.sectors) {
                // A cell may be just reliable enough on one side only: quantiles then are another cell's.
                if found.coverage != expected.coverage || !found.is_known() {
                    continue;
                }
                compared += 1;
                let [a, b] = [found, expected].map(|sector| sector.nearness_rate_hz[1]);
                assert!((a - b).abs() <= 2e-3 + 5e-3 * b.abs(), "{a} {b} at {derotation:?}");
                assert!((found.flow_rad_s - expected.flow_rad_s).length() <= 1e-3, "{found:?} {expected:?}");
            }
            assert!(invalid.is_some() || compared > 60, "{compared} sectors compared");
        }
    }
}

#[test]
fn the_first_frame_and_one_too_late_make_no_pair() {
    let camera = small();
    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &PipelineConfig::default()));
    let frames = frames(&camera, 4);
    let times = [0.0, 1.0, 1.0, 1.03];
    let expected = [
        Some(Invalid::First),
        Some(Invalid::Interval { interval_s: 1.0, limit_s: 0.25 }),
        Some(Invalid::Interval { interval_s: 0.0, limit_s: 0.25 }),
        None,
    ];
    for (((_, image), time_s), expected) in frames.iter().zip(times).zip(expected) {
        let cue = good(pipeline.process(&good(image.frame()), time_s));
        assert_eq!(cue.invalid, expected);
        assert_eq!(cue.sectors.coverage() > 0.0, expected.is_none());
    }
    pipeline.reset();
    let cue = good(pipeline.process(&good(frames[0].1.frame()), 1.06));
    assert_eq!(cue.invalid, Some(Invalid::First));
}

#[test]
fn a_gyro_that_is_silent_or_wrong_spoils_its_frames_only() {
    let camera = small();
    let frames = frames(&camera, 8);
    let spoiled = |keep: &dyn Fn(f64) -> bool, wrong: Option<GyroSample>| {
        let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &with_gyro()));
        gyro(&mut pipeline, |time_s| time_s < 0.18 && keep(time_s));
        wrong.into_iter().for_each(|sample| pipeline.push_gyro(sample));
        gyro(&mut pipeline, |time_s| time_s >= 0.18 && keep(time_s));
        let mut reasons = Vec::new();
        for (time_s, image) in &frames {
            let cue = good(pipeline.process(&good(image.frame()), *time_s));
            reasons.push(cue.invalid.map(|invalid| invalid.to_string()));
        }
        assert_eq!(reasons[0].as_deref(), Some("no previous frame"));
        reasons.split_off(1)
    };
    let none: Vec<Option<String>> = vec![None; 7];
    assert_eq!(spoiled(&|_| true, None), none);

    // A gap of 0.1 s from 0.15 s on touches the frames at 0.167, 0.2, 0.233 and 0.267 s.
    let gap = spoiled(&|time_s| !(0.15..0.25).contains(&time_s), None);
    let touched: Vec<bool> = gap.iter().map(Option::is_some).collect();
    assert_eq!(touched, [false, true, true, true, true, false, false], "{gap:?}");
    assert!(
        gap[1].as_ref().is_some_and(|reason| reason.starts_with("gyro: no gyro sample between")),
        "{gap:?}"
    );

    let nan = GyroSample { time_s: 0.1775, gyro_rad_s: DVec3::NAN };
    let nan = spoiled(&|_| true, Some(nan));
    assert!(nan[2].is_some() && nan[0].is_none() && nan[5].is_none(), "{nan:?}");

    let back = GyroSample { time_s: 0.02, gyro_rad_s: DVec3::ZERO };
    let back = spoiled(&|_| true, Some(back));
    assert!(back.iter().flatten().any(|reason| reason.contains("came after")), "{back:?}");
    assert_eq!(back[5..], none[5..]);

    let short = spoiled(&|time_s| time_s < 0.22, None);
    assert!(short[3].as_ref().is_some_and(|reason| reason.contains("not covered")), "{short:?}");
}

#[test]
fn what_is_not_textured_or_masked_is_not_trusted() {
    let camera = small();
    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &PipelineConfig::default()));
    let flat = Image { data: vec![90; camera.size.pixels()], ..frames(&camera, 1).remove(0).1 };
    good(pipeline.process(&good(flat.frame()), 0.0));
    let brighter = Image { data: vec![91; camera.size.pixels()], ..flat.clone() };
    let cue = good(pipeline.process(&good(brighter.frame()), 0.03));
    assert!(
        matches!(cue.invalid, Some(Invalid::Coverage { found, .. }) if found == 0.0),
        "{:?}",
        cue.invalid
    );

    // The lower third is the aircraft's own nose.
    let rows = camera.size.height as usize;
    let masked = |i: usize| if i / 320 < 2 * rows / 3 { 1.0 } else { 0.0 };
    let mask = Plane { size: camera.size, data: (0..camera.size.pixels()).map(masked).collect() };
    for certainty in [false, true] {
        let mut config = PipelineConfig { mask: Some(mask.clone()), ..with_gyro() };
        config.certainty = certainty;
        let (invalid, sectors, _) =
            run(Backend::Cpu, &camera, &config).pop().unwrap_or_else(|| panic!("no cue"));
        assert_eq!(invalid, None);
        let row = |row: usize| (0..24).map(|column| sectors.get(column, row).coverage).sum::<f64>() / 24.0;
        assert!(row(4) > 0.5 && row(7) == 0.0 && row(8) == 0.0, "{} {} {}", row(4), row(7), row(8));
    }
}

#[test]
fn the_ideal_picture_may_have_its_own_size_and_fields_are_read() {
    let camera = small();
    let ideal =
        Camera { size: Size::new(200, 150), f_u: 110.0, f_v: 110.0, u_0: 99.5, v_0: 74.5, lens: Lens::NONE };
    let config = PipelineConfig {
        ideal: Some(ideal),
        fields: ExtraOutputs { looming: true, cells: true, spherical_flow: true },
        ..with_gyro()
    };
    let mut config_with_flow = config.clone();
    config_with_flow.read_flow = true;
    for backend in [Some(Backend::Cpu), need::gpu_if_any().map(Backend::Gpu)].into_iter().flatten() {
        let mut pipeline = good(Pipeline::new(backend, &camera, &config_with_flow));
        gyro(&mut pipeline, |_| true);
        assert_eq!((pipeline.cells().size, pipeline.ideal().size), (Size::new(25, 19), ideal.size));
        for (i, (time_s, image)) in frames(&camera, 3).iter().enumerate() {
            let cue = good(pipeline.process(&good(image.frame()), *time_s));
            assert_eq!(cue.frame, i as u64);
            if i == 0 {
                continue;
            }
            let lengths = [cue.looming, cue.cells, cue.spherical_flow].map(|values| values.map(<[f32]>::len));
            assert_eq!(lengths, [28 * 19 * 4, 28 * 19 * 6, 200 * 150 * 3].map(Some));
            assert_eq!(cue.flow.map(|flow| flow.size), Some(ideal.size));
            assert_eq!(cue.invalid, None);
        }
    }
}

#[test]
fn cells_may_be_single_pixels() {
    let camera = camera().resized(Size::new(161, 121));
    let rates = |cell: u32, window: u32, backend: Backend| {
        let sphere = Sphere { cell, step: 1, window, sectors: [6, 5], ..Sphere::default() };
        let (invalid, sectors, _) = run(backend, &camera, &PipelineConfig { sphere, ..with_gyro() })
            .pop()
            .unwrap_or_else(|| panic!("no cue"));
        assert_eq!(invalid, None);
        let known = |sector: &viewsphere::sphere::Sector| sector.coverage > 0.2;
        let rates: Vec<Option<f64>> = (sectors.sectors.iter())
            .map(|sector| known(sector).then_some(sector.nearness_rate_hz[1]))
            .collect();
        rates
    };
    let wide = rates(8, 1, Backend::Cpu);
    for backend in [Some(Backend::Cpu), need::gpu_if_any().map(Backend::Gpu)].into_iter().flatten() {
        let fine = rates(1, 8, backend);
        let mut ratios: Vec<f64> = wide
            .iter()
            .zip(&fine)
            .filter_map(|(wide, fine)| Some((fine.as_ref()? / wide.as_ref()? - 1.0).abs()))
            .collect();
        assert!(ratios.len() >= 6, "{} sectors compared", ratios.len());
        let median = crate::quantile::quantile(&mut ratios, 0.5);
        assert!(median < 0.1, "{median}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let camera = small();
    let new = |camera: &Camera, config: PipelineConfig| Pipeline::new(Backend::Cpu, camera, &config).err();
    let text = |error: Option<Error>| error.map(|error| error.to_string()).unwrap_or_default();
    let mask = Plane { size: Size::new(3, 2), data: vec![1.0; 6] };
    let wrong = text(new(&camera, PipelineConfig { mask: Some(mask), ..PipelineConfig::default() }));
    assert_eq!(wrong, "mask is 3×2, expected 320×240");
    let with_lens = PipelineConfig { ideal: Some(camera), ..PipelineConfig::default() };
    assert_eq!(text(new(&camera, with_lens)), "ideal is a camera with a lens, expected one without");
    let sectors = Sphere { sectors: [0, 9], ..Sphere::default() };
    let wrong = text(new(&camera, PipelineConfig { sphere: sectors, ..PipelineConfig::default() }));
    assert_eq!(wrong, "sectors is 0, expected 1 to 256");
    let other = Camera { f_u: -1.0, ..camera };
    assert!(text(new(&other, PipelineConfig::default())).starts_with("f_u is -1"));

    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &PipelineConfig::default()));
    let image = frames(&self::camera(), 1).remove(0).1;
    let error = pipeline.process(&good(image.frame()), 0.0).err();
    assert_eq!(text(error), "frame is 640×480, expected 320×240");
}

#[test]
fn frames_in_flight_keep_their_times() {
    let camera = small();
    let mut config = with_gyro();
    config.stream.in_flight = 3;
    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &config));
    gyro(&mut pipeline, |_| true);
    let frames = frames(&camera, 3);
    let tickets: Vec<_> =
        frames.iter().map(|(time_s, image)| good(pipeline.submit(&good(image.frame()), *time_s))).collect();
    for (ticket, (time_s, _)) in tickets.into_iter().zip(&frames) {
        let cue = good(pipeline.wait(ticket));
        assert_eq!(cue.time_s, *time_s);
        assert_eq!(cue.invalid, (cue.frame == 0).then_some(Invalid::First));
    }
}

/// A camera that repeats its last image looks like a world at rest. When it resumes, its image is compared with the
/// time of the last new one.
#[test]
fn a_picture_that_is_shown_again_makes_no_cue() {
    let camera = small();
    let frames = frames(&camera, 6);
    // Over a tenth of a second the camera rotates so far that both views share little.
    let config = PipelineConfig { least_coverage: 0.05, ..with_gyro() };
    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &config));
    gyro(&mut pipeline, |_| true);
    let shown = [0, 1, 2, 2, 2, 5];
    let cues: Vec<(Option<Invalid>, Option<f64>, f64)> = (shown.into_iter().zip(&frames))
        .map(|(shown, (time_s, _))| {
            let cue = good(pipeline.process(&good(frames[shown].1.frame()), *time_s));
            (cue.invalid, cue.interval_s, cue.sectors.get(12, 4).nearness_rate_hz[1])
        })
        .collect();
    assert!(
        matches!(cues[3].0, Some(Invalid::Frozen)) && matches!(cues[4].0, Some(Invalid::Frozen)),
        "{cues:?}"
    );
    assert_eq!((&cues[2].0, &cues[5].0), (&None, &None));
    assert!(cues[5].1.is_some_and(|interval_s| (interval_s - 0.1).abs() < 1e-9), "{cues:?}");
    // A tenth of a second later it is a little nearer, not three times as near.
    assert!((cues[5].2 / cues[2].2 - 1.0).abs() < 0.3, "{cues:?}");
}

/// However long an image is repeated, that stays the reason; but missing frames are distinguished from it.
#[test]
fn a_picture_that_is_shown_for_long_stays_the_reason() {
    let camera = small();
    let frames = frames(&camera, 2);
    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &PipelineConfig::default()));
    let mut reason =
        |shown: usize, time_s: f64| good(pipeline.process(&good(frames[shown].1.frame()), time_s)).invalid;
    assert_eq!(reason(0, 0.0), Some(Invalid::First));
    for frame in 1..20 {
        assert_eq!(reason(0, f64::from(frame) / 30.0), Some(Invalid::Frozen), "{frame}");
    }
    // A gap with the same image on both sides is a gap, and so is a time that is NaN.
    for time_s in [5.0, 4.0, f64::NAN] {
        assert!(matches!(reason(0, time_s), Some(Invalid::Interval { .. })), "{time_s}");
    }
    assert!(matches!(reason(0, 6.0), Some(Invalid::Interval { .. })));
    assert_eq!(reason(0, 6.1), Some(Invalid::Frozen));
    // The first new image is not paired with one from long ago.
    assert!(matches!(reason(1, 6.5), Some(Invalid::Interval { .. })));
}
