//! The parameters of steering by name: their ranges, and how they are set from text.

use super::SteerParams;
use crate::error::{Error, Result, in_ranges};

/// A number among the parameters: its name, its place, and its least and greatest value.
type Number<'a> = (&'static str, &'a mut f64, f64, f64);

/// The name of the parameter that is not a number.
const READING: &str = "reading";

impl SteerParams {
    /// All parameters that [`SteerParams::set`] takes, with their values as text: `reading`, and the numbers in the order of
    /// the struct. A number's name is that of its field, with the axis for those of a pair (`map_half_azimuth_rad`), and
    /// one of its own in a nested struct (`weight_goal`, `recovery_climb_rad`).
    pub fn named(&self) -> Vec<(&'static str, String)> {
        let mut copy = *self;
        let numbers = copy.numbers().into_iter().map(|(name, value, ..)| (name, value.to_string()));
        std::iter::once((READING, self.reading.to_string())).chain(numbers).collect()
    }

    /// Sets a parameter from text. It does not check the range: [`SteerParams::validate`] does.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name, and for text that is no value of the parameter.
    pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
        if name == READING {
            self.reading = value.trim().parse()?;
            return Ok(());
        }
        let known = self.numbers().into_iter().find(|(known, ..)| *known == name);
        let Some((name, place, low, high)) = known else {
            let names: Vec<&str> = Self::default().named().into_iter().map(|(name, _)| name).collect();
            return Err(Error::parameter("steering parameter", format_args!("{name:?}"), names.join(", ")));
        };
        let wrong = |_| Error::parameter(name, format_args!("{value:?}"), format_args!("{low} to {high}"));
        *place = value.trim().parse().map_err(wrong)?;
        Ok(())
    }

    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<()> {
        let mut copy = *self;
        let numbers = copy.numbers().into_iter().map(|(name, value, low, high)| (name, *value, low, high));
        in_ranges(&numbers.collect::<Vec<_>>())
    }

    fn numbers(&mut self) -> Vec<Number<'_>> {
        let quarter = std::f64::consts::FRAC_PI_4;
        let widest = self.map_half_rad.map(|half| 2.0 * half);
        let [half_azimuth, half_elevation] = &mut self.map_half_rad;
        let [pitch_azimuth, pitch_elevation] = &mut self.map_pitch_rad;
        vec![
            ("post_m", &mut self.post_m, 0.0, 1e3),
            ("distance_scale", &mut self.distance_scale, 0.01, 2.0),
            ("max_bank_rad", &mut self.max_bank_rad, 1e-3, 1.5),
            ("max_climb_rad", &mut self.max_climb_rad, 0.0, quarter),
            ("horizon_s", &mut self.horizon_s, 0.1, 10.0),
            ("radius_m", &mut self.radius_m, 1e-3, 1e3),
            ("softness_m", &mut self.softness_m, 1e-3, 1e3),
            ("discount_s", &mut self.discount_s, 1e-3, 1e3),
            ("weight_danger", &mut self.weights.danger, 0.0, 1e6),
            ("weight_goal", &mut self.weights.goal, 0.0, 1e6),
            ("weight_change", &mut self.weights.change, 0.0, 1e6),
            ("weight_bank", &mut self.weights.bank, 0.0, 1e6),
            ("weight_climb", &mut self.weights.climb, 0.0, 1e6),
            ("least_rate_hz", &mut self.least_rate_hz, 1e-3, 1e3),
            ("least_coverage", &mut self.least_coverage, 0.0, 1.0),
            ("smoothing", &mut self.smoothing, 1e-3, 1.0),
            ("memory_s", &mut self.memory_s, 0.0, 10.0),
            ("half_width_rad", &mut self.half_width_rad, 0.0, quarter),
            ("map_half_azimuth_rad", half_azimuth, 0.01, 3.1),
            ("map_half_elevation_rad", half_elevation, 0.01, 1.5),
            ("map_pitch_azimuth_rad", pitch_azimuth, 0.01, widest[0]),
            ("map_pitch_elevation_rad", pitch_elevation, 0.01, widest[1]),
            ("climb_per_m", &mut self.climb_per_m, 0.0, 10.0),
            ("hold_s", &mut self.on_invalid.hold_s, 0.0, 60.0),
            ("recovery_climb_rad", &mut self.on_invalid.climb_rad, -quarter, quarter),
        ]
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_number_is_set_and_checked_by_its_name() {
        let named = SteerParams::default().named();
        assert_eq!(named.iter().map(|(name, _)| *name).collect::<BTreeSet<_>>().len(), named.len());
        for (name, _) in named.into_iter().filter(|(name, _)| *name != READING) {
            let mut params = SteerParams::default();
            let (_, value, low, high) =
                params.numbers().into_iter().find(|(known, ..)| *known == name).unwrap();
            assert!((low..=high).contains(value), "{name}");
            let other = low + 0.37 * (high - low);
            params.set(name, &format!(" {other} ")).unwrap();
            assert_ne!(params, SteerParams::default(), "{name}");
            for wrong in ["nan", "1e9", "-1e9"] {
                params.set(name, wrong).unwrap();
                let error = params.validate().unwrap_err().to_string();
                assert!(error.contains(&format!("expected {low} to ")), "{name}: {error}");
            }
        }
    }

    #[test]
    fn what_is_unknown_or_no_number_is_named() {
        let error =
            |name: &str, value: &str| SteerParams::default().set(name, value).unwrap_err().to_string();
        assert!(
            error("radius", "1").starts_with("steering parameter is \"radius\", expected reading, post_m, ")
        );
        assert_eq!(error("reading", "rows"), "reading is \"rows\", expected sectors, columns");
        assert_eq!(error("radius_m", "wide"), "radius_m is \"wide\", expected 0.001 to 1000");
    }
}
