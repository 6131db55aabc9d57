/// Why there is no rotation for an interval. The camera's cue of that frame is invalid then, and only of that frame.
///
/// Times are in seconds of the camera's clock.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GyroFault {
    /// Not one sample has come.
    #[error("no gyro sample has come")]
    Empty,
    /// The samples do not reach over the whole interval: they are late, or the interval is too long ago.
    #[error(
        "{from_s:.6} s to {to_s:.6} s is not covered by gyro samples, which reach from {first_s:.6} s to {last_s:.6} s"
    )]
    NotCovered {
        /// The interval's beginning.
        from_s: f64,
        /// The interval's end.
        to_s: f64,
        /// Time of the oldest sample kept.
        first_s: f64,
        /// Time of the newest sample.
        last_s: f64,
    },
    /// Two samples are too far apart for what was between them to be known.
    #[error("no gyro sample between {from_s:.6} s and {to_s:.6} s, a gap of at most {limit_s} s is allowed")]
    Gap {
        /// Time of the sample before the gap.
        from_s: f64,
        /// Time of the sample behind it.
        to_s: f64,
        /// The longest gap allowed, seconds.
        limit_s: f64,
    },
    /// A sample was not a number, or no finite one.
    #[error("a gyro sample at or after {time_s:.6} s is not a finite number")]
    NotANumber {
        /// The sample's time, or if that is what is wrong the time of the one before; NaN if there was none.
        time_s: f64,
    },
    /// A sample was older than the one before it, or as old with other rates.
    #[error("a gyro sample of {time_s:.6} s came after one of {after_s:.6} s, times must rise")]
    Backwards {
        /// The sample's time.
        time_s: f64,
        /// The time of the sample before it.
        after_s: f64,
    },
    /// The two exposures are in the wrong order, or their times are not numbers.
    #[error("frame at {cur_time_s:.6} s follows one at {prev_time_s:.6} s, times must rise")]
    Frames {
        /// Time of the earlier frame.
        prev_time_s: f64,
        /// Time of the later frame.
        cur_time_s: f64,
    },
}
