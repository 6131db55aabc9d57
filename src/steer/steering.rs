use std::collections::VecDeque;

use glam::DVec3;

use super::arc::{self, Arc};
use super::observation::{Moving, Observation, View};
use super::obstacles::{Obstacle, Obstacles, ViewGeometry};
use super::simple::{self, Level};
use super::{Command, DangerMap, Policy, SteerConfig};
use crate::error::Result;

/// Steering: computes a command per frame.
#[derive(Clone, Debug)]
pub struct Steering {
    config: SteerConfig,
    map: DangerMap,
    obstacles: Obstacles,
    arc: Option<Arc>,
    last: Command,
    /// Commands in effect now or later, oldest first, each with the time of its frame.
    given: VecDeque<(f64, Command)>,
    /// Commands in effect before a new one is, each with its end in seconds from now.
    acting: Vec<(f64, Command)>,
    last_heading_rad: f64,
    /// The last observation: its time, and the velocity along north, east and down.
    before: Option<(f64, DVec3)>,
    /// The time of the last frame with a valid cue.
    seen_s: Option<f64>,
}

/// The source of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The view.
    Cue,
    /// The last command, held because there is no valid cue.
    Held,
    /// Level wings and the configured climb, as there has been no valid cue for longer.
    Recovery,
}

/// A command and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// The command to fly.
    pub command: Command,
    /// The source of the command.
    pub source: Source,
    /// The obstacles' part of the chosen arc's cost, relative to the weight of the danger: 0 is free, 1 an immediate
    /// collision. `None` for policies without arcs.
    pub danger: Option<f64>,
}

impl Steering {
    /// Steering without a history.
    ///
    /// # Errors
    /// As in [`SteerConfig::validate`].
    pub fn new(config: SteerConfig) -> Result<Self> {
        config.validate()?;
        Ok(Self {
            map: DangerMap::new(&config.params),
            obstacles: Obstacles::default(),
            arc: None,
            last: Command::default(),
            given: VecDeque::new(),
            acting: Vec::new(),
            last_heading_rad: 0.0,
            before: None,
            seen_s: None,
            config,
        })
    }

    /// The configuration.
    pub fn config(&self) -> &SteerConfig {
        &self.config
    }

    /// The map of danger, after the last frame with a valid cue.
    pub fn map(&self) -> &DangerMap {
        &self.map
    }

    /// The known obstacles, those in view first, after the last frame.
    pub fn obstacles(&self) -> &[Obstacle] {
        self.obstacles.all()
    }

    /// Those of them that the last frame with a valid cue showed.
    pub fn obstacles_in_view(&self) -> &[Obstacle] {
        self.obstacles.in_view()
    }

    /// The arc chosen at the last frame, if the policy evaluates arcs.
    pub fn arc(&self) -> Option<&Arc> {
        self.arc.as_ref()
    }

    /// Forgets all observations and commands.
    pub fn reset(&mut self) {
        self.map.reset();
        self.obstacles.reset();
        (self.arc, self.last, self.last_heading_rad) = (None, Command::default(), 0.0);
        (self.before, self.seen_s) = (None, None);
        self.given.clear();
    }

    /// Computes the command to fly from this frame on.
    ///
    /// An observation whose time, attitude or airspeed is NaN, or whose airspeed is not above 0, counts as one
    /// without a cue.
    pub fn update(&mut self, o: &Observation<'_>) -> Decision {
        let sound = o.time_s.is_finite() && o.ned_from_body.is_finite() && o.airspeed_m_s > 0.1;
        if o.time_s.is_finite() {
            self.look_back(o.time_s);
        }
        let decision = match o.view.filter(|_| sound && o.airspeed_m_s.is_finite()) {
            Some(view) => self.steer(o, &view),
            None => self.without_cue(o.time_s),
        };
        self.last = decision.command;
        if o.time_s.is_finite() {
            self.given.push_back((o.time_s, decision.command));
        }
        decision
    }

    fn steer(&mut self, o: &Observation<'_>, view: &View<'_>) -> Decision {
        let moving = Moving::of(&self.config.aircraft, o);
        let ned_from_level = moving.ned_from_level();
        let ned_from_camera = o.ned_from_body * self.config.aircraft.body_from_camera;
        let camera_from_ned = ned_from_camera.transpose();
        let velocity = o.airspeed_m_s
            * DVec3::new(
                moving.climb_rad.cos() * moving.yaw_rad.cos(),
                moving.climb_rad.cos() * moving.yaw_rad.sin(),
                -moving.climb_rad.sin(),
            );
        let before_s = match self.before {
            Some((before_s, before)) if o.time_s > before_s => {
                self.obstacles.moved(0.5 * (before + velocity) * (o.time_s - before_s));
                before_s
            }
            _ => o.time_s,
        };
        self.before = Some((o.time_s, velocity));
        self.map.update(&self.config.params, view.sectors, &(camera_from_ned * ned_from_level));
        let frame = ViewGeometry {
            ned_from_level: &ned_from_level,
            camera_from_ned: &camera_from_ned,
            sectors: view.sectors,
            speed_m_s: o.airspeed_m_s,
        };
        self.obstacles.see(&self.config.params, &self.map, frame, [before_s, o.time_s]);
        self.seen_s = Some(o.time_s);
        let level =
            Level { from_camera: ned_from_level.transpose() * ned_from_camera, ned_from: ned_from_level };
        let (params, goal, obstacles) = (&self.config.params, &o.goal, self.obstacles.all());
        self.arc = None;
        let command = match params.policy {
            Policy::None => simple::none(params, &moving, goal),
            Policy::Balance => simple::balance(params, &moving, goal, view, &level),
            Policy::Potential => simple::potential(params, &moving, goal, obstacles, &level),
            Policy::Heading => simple::heading(params, &moving, goal, obstacles, &mut self.last_heading_rad),
            Policy::Arc => {
                let start = arc::Start { moving, goal: *goal, last: self.last, acting: &self.acting };
                self.arc.insert(arc::cheapest(&self.config, &start, obstacles)).command
            }
        };
        let danger = self
            .arc
            .as_ref()
            .map(|arc| arc.danger / self.config.params.weights.danger.max(f64::MIN_POSITIVE));
        Decision { command: self.config.params.limited(command), source: Source::Cue, danger }
    }

    /// Determines the commands in effect from now until the new one.
    fn look_back(&mut self, time_s: f64) {
        let delay_s = self.config.aircraft.delay_s();
        // If time went backwards, the commands given since then no longer apply.
        while self.given.back().is_some_and(|(given_s, _)| *given_s >= time_s) {
            self.given.pop_back();
        }
        // The oldest one is in effect until the second one is.
        while self.given.get(1).is_some_and(|(given_s, _)| !(given_s + delay_s > time_s)) {
            self.given.pop_front();
        }
        let until_s = self.given.iter().skip(1).map(|(given_s, _)| given_s + delay_s - time_s);
        let until_s = until_s.chain(std::iter::once(delay_s));
        self.acting.clear();
        self.acting.extend(until_s.zip(self.given.iter().map(|(_, command)| *command)));
    }

    fn without_cue(&mut self, time_s: f64) -> Decision {
        self.arc = None;
        let since = self.seen_s.map_or(f64::INFINITY, |seen_s| time_s - seen_s);
        let on_invalid = self.config.params.on_invalid;
        let (command, source) = if since <= on_invalid.hold_s {
            (self.last, Source::Held)
        } else {
            (Command { bank_rad: 0.0, climb_rad: on_invalid.climb_rad }, Source::Recovery)
        };
        Decision { command: self.config.params.limited(command), source, danger: None }
    }
}
