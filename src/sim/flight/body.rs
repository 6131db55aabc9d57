//! The vehicle of a flight.

use super::clock::FRAME_S;
use crate::camera::FRD_FROM_CAMERA;
use crate::error::{Error, Result};
use crate::sim::vehicle::{
    Airframe, AirframeParams, Autopilot, CoordinatedTurn, Start, TurnParams, Vehicle, Wind,
};
use crate::steer::{Aircraft, Response};

/// The vehicle of a flight, with its parameters.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Body {
    /// A point in coordinated turns. Its response to commands is known exactly.
    Turn(TurnParams),
    /// A rigid body with an inner control loop.
    Airframe {
        /// The airframe's parameters.
        params: Box<AirframeParams>,
        /// The inner loop's gains.
        autopilot: Autopilot,
        /// The response to commands that steering assumes.
        response: Response,
    },
}

impl Default for Body {
    fn default() -> Self {
        Self::Airframe {
            params: Box::default(),
            autopilot: Autopilot::default(),
            response: Response::default(),
        }
    }
}

impl Body {
    /// Checks every parameter, and that the body can fly level at the speed.
    pub(super) fn validate(&self, speed_m_s: f64) -> Result<()> {
        match self {
            Self::Turn(params) => {
                params.validate()?;
                if !(0.1..=1e3).contains(&speed_m_s) {
                    return Err(Error::parameter("speed_m_s", speed_m_s, "0.1 to 1000 m/s"));
                }
            }
            Self::Airframe { params, autopilot, response } => {
                autopilot.validate()?;
                response.validate()?;
                params.trim(speed_m_s)?;
            }
        }
        Ok(())
    }

    /// The vehicle in its initial state.
    pub(super) fn vehicle(&self, start: &Start, wind: Wind) -> Result<Box<dyn Vehicle>> {
        Ok(match self {
            Self::Turn(params) => Box::new(CoordinatedTurn::new(params, start, wind)?),
            Self::Airframe { params, autopilot, .. } => {
                Box::new(Airframe::new(params, autopilot, start, wind)?)
            }
        })
    }

    /// The aircraft as steering sees it: a camera along the body's x axis, and commands that take effect
    /// `latency_frames` after an exposure.
    pub(super) fn aircraft(&self, latency_frames: u32) -> Aircraft {
        let response = match self {
            Self::Turn(turn) => Response {
                bank_time_s: turn.bank_lag_s,
                bank_rate_rad_s: turn.bank_rate_rad_s,
                climb_time_s: turn.climb_lag_s,
                lag_s: 0.0,
            },
            Self::Airframe { response, .. } => *response,
        };
        Aircraft {
            body_from_camera: FRD_FROM_CAMERA,
            latency_s: f64::from(latency_frames) * FRAME_S,
            response,
        }
    }
}
