/// Why the rotation over an interval is unknown. The cue of that frame alone is invalid.
///
/// Times are in seconds of the camera's clock.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GyroFault {
    /// No sample has arrived.
    #[error("no gyro sample has arrived")]
    Empty,
    /// The samples do not cover the whole interval: they are late, or it lies too far back.
    #[error(
        "{from_s:.6} s to {to_s:.6} s is not covered by gyro samples, which reach from {first_s:.6} s to {last_s:.6} s"
    )]
    NotCovered {
        /// The start of the interval.
        from_s: f64,
        /// The end of the interval.
        to_s: f64,
        /// Time of the oldest sample kept.
        first_s: f64,
        /// Time of the newest sample.
        last_s: f64,
    },
    /// Two samples are too far apart to interpolate between them.
    #[error("no gyro sample between {from_s:.6} s and {to_s:.6} s, a gap of at most {limit_s} s is allowed")]
    Gap {
        /// Time of the sample before the gap.
        from_s: f64,
        /// Time of the sample after the gap.
        to_s: f64,
        /// The longest gap allowed, seconds.
        limit_s: f64,
    },
    /// A sample was NaN or infinite.
    #[error("a gyro sample at or after {time_s:.6} s is not a finite number")]
    NotANumber {
        /// The sample's time, or the previous sample's if the time itself is not finite; NaN if there was none.
        time_s: f64,
    },
    /// A sample was older than the previous one, or as old with other rates.
    #[error("a gyro sample of {time_s:.6} s came after one of {after_s:.6} s, times must rise")]
    Backwards {
        /// The sample's time.
        time_s: f64,
        /// The previous sample's time.
        after_s: f64,
    },
    /// The two exposures are in the wrong order, or their times are NaN.
    #[error("frame at {cur_time_s:.6} s follows one at {prev_time_s:.6} s, times must rise")]
    Frames {
        /// Time of the earlier frame.
        prev_time_s: f64,
        /// Time of the later frame.
        cur_time_s: f64,
    },
}
