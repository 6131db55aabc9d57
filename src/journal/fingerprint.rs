//! The fingerprint of a configuration.

use serde::Serialize;

use crate::error::{Error, Result};
use crate::fnv::Fnv1a;

/// A fingerprint of a configuration and of this crate's version: 16 hexadecimal digits that differ if either differs.
///
/// It is the FNV-1a hash of the version and the configuration as canonical JSON: members sorted by name, numbers as the
/// shortest decimals that are read back the same. JSON has no infinity; an infinite parameter becomes `null`.
///
/// # Errors
/// [`Error::Parameter`] for a value that JSON cannot represent, such as a map whose keys are not text.
pub fn fingerprint(configuration: &impl Serialize) -> Result<String> {
    let text = format!("{} {}", env!("CARGO_PKG_VERSION"), canonical(configuration)?);
    let mut hash = Fnv1a::default();
    hash.add(text.as_bytes());
    Ok(hash.text())
}

fn canonical(configuration: &impl Serialize) -> Result<String> {
    let mut value = serde_json::to_value(configuration)
        .map_err(|error| Error::parameter("configuration", error, "a value that JSON can represent"))?;
    // Objects are sorted already, unless another crate enables serde_json's `preserve_order`.
    value.sort_all_objects();
    Ok(value.to_string())
}

#[cfg(all(test, feature = "sim"))]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeSet;
    use std::time::Duration;

    use serde_json::{Value, json};

    use super::*;
    use crate::frame::{Plane, Size};
    use crate::imu::GyroConfig;
    use crate::sim::flight::{Body, FlightConfig};
    use crate::sim::vehicle::{Gusts, TurnParams, VaneErrors};

    /// A configuration with every optional part.
    fn full() -> FlightConfig {
        let mut config = FlightConfig::default();
        config.pipeline.stream.deadline = Some(Duration::from_millis(7));
        config.pipeline.ideal = Some(config.camera);
        config.pipeline.mask = Some(Plane { size: Size::new(1, 1), data: vec![0.5] });
        config.pipeline.gyro = Some(GyroConfig::default());
        (config.vanes, config.gusts) = (Some(VaneErrors::default()), Some(Gusts::LIGHT));
        config.faults = vec!["black:1..2".parse().unwrap(), "dropped=0.3".parse().unwrap()];
        config
    }

    /// The paths of all values that are neither arrays nor objects.
    fn leaves(value: &Value, path: &str, found: &mut Vec<String>) {
        match value {
            Value::Object(members) => {
                members.iter().for_each(|(name, value)| leaves(value, &format!("{path}/{name}"), found));
            }
            Value::Array(list) => {
                (0..)
                    .zip(list)
                    .for_each(|(i, value): (usize, _)| leaves(value, &format!("{path}/{i}"), found));
            }
            _ => found.push(path.to_owned()),
        }
    }

    /// The names of all members, nested ones included.
    fn names(value: &Value, found: &mut Vec<String>) {
        match value {
            Value::Object(members) => members.iter().for_each(|(name, value)| {
                found.push(name.clone());
                names(value, found);
            }),
            Value::Array(list) => list.iter().for_each(|value| names(value, found)),
            _ => (),
        }
    }

    #[test]
    fn the_form_is_canonical() {
        let unordered = json!({"b": [0.1, 1e300, -0.0], "a": {"d": null, "c": u64::MAX}});
        let expected = r#"{"a":{"c":18446744073709551615,"d":null},"b":[0.1,1e+300,-0.0]}"#;
        assert_eq!(canonical(&unordered).unwrap(), expected);
    }

    /// The derived `Debug` shows every field, even one that serde skips.
    #[test]
    fn every_field_is_in_it() {
        for body in [Body::default(), Body::Turn(TurnParams::default())] {
            let config = FlightConfig { body, ..full() };
            let mut written = Vec::new();
            names(&serde_json::to_value(&config).unwrap(), &mut written);
            // Variants are capitalised. The parts of a duration have no name in `Debug`.
            written
                .retain(|name| name.starts_with(char::is_lowercase) && !["secs", "nanos"].contains(&&**name));
            let shown = format!("{config:#?}");
            let field = |line: &str| line.trim().split_once(':').map(|(name, _)| name.to_owned());
            let mut fields: Vec<String> = shown.lines().filter_map(field).collect();
            // `Debug` names the columns of a matrix, which serde writes as an array.
            fields.retain(|name| !["x_axis", "y_axis", "z_axis"].contains(&&**name));
            written.sort();
            fields.sort();
            assert!(fields.len() > 100, "{fields:?}");
            assert_eq!(written, fields);
        }
    }

    #[test]
    fn any_member_that_changes_changes_it() {
        let config = full();
        let whole = serde_json::to_value(&config).unwrap();
        let before = fingerprint(&config).unwrap();
        assert_eq!(fingerprint(&config.clone()).unwrap(), before);
        assert_eq!(fingerprint(&whole).unwrap(), before);
        let mut places = Vec::new();
        leaves(&whole, "", &mut places);
        let mut all = BTreeSet::from([before]);
        for place in &places {
            let mut changed = whole.clone();
            let leaf = changed.pointer_mut(place).unwrap();
            *leaf = match &*leaf {
                Value::Null => json!(0),
                Value::Bool(on) => json!(!on),
                Value::String(text) => json!(format!("{text}x")),
                // Even the last bit of a number counts.
                Value::Number(number) => match number.as_u64() {
                    Some(whole) => json!(whole ^ 1),
                    None => json!(number.as_f64().unwrap().next_up()),
                },
                other => unreachable!("{other} is no leaf"),
            };
            assert!(all.insert(fingerprint(&changed).unwrap()), "{place} does not count");
        }
        assert!(places.len() > 100, "{places:?}");
    }

    #[test]
    fn a_field_that_changes_changes_it() {
        let config = FlightConfig::default();
        let mut other = config.clone();
        other.steer.weights.bank += 1e-12;
        assert_ne!(fingerprint(&config).unwrap(), fingerprint(&other).unwrap());
    }
}
