#![allow(clippy::unwrap_used)]

use std::time::Duration;

use glam::DVec3;
use serde_json::{Value, json};

use super::*;
use crate::pipeline::Invalid;
use crate::sphere::{Grid, Heading, Sector, Threat};

/// Two sectors: one that comes nearer, and an unknown one.
fn sectors() -> Sectors {
    let grid = Grid { columns: 2, rows: 1, azimuth_rad: [-0.5, 0.5], elevation_rad: [0.2, -0.2] };
    let mut sectors = Sectors::unknown(grid);
    sectors.interval_s = 0.04;
    sectors.sectors[0] = Sector {
        coverage: 0.512,
        confidence: 0.25,
        nearness_rate_hz: [0.25, 0.5, 1.0],
        nearness_error_hz: 0.1,
        divergence_hz: 1.234_56,
        flow_rad_s: DVec3::ZERO,
    };
    sectors
}

fn message(invalid: Option<Invalid>, detail: bool) -> CueMessage {
    let cue = Cue {
        frame: 3,
        time_s: 0.12,
        interval_s: Some(0.04),
        invalid,
        prev_from_cur: None,
        residual_rotation_rad_s: None,
        heading: Heading { direction: DVec3::Z, error_rad: 0.01 },
        sectors: &sectors(),
        threat: Some(Threat { azimuth_rad: -0.1, elevation_rad: 0.0, time_s: 1.5, sectors: 1, alarm: true }),
        flow: None,
        looming: None,
        cells: None,
        spherical_flow: None,
        latency: Duration::ZERO,
    };
    let timing = Timing { age_ms: 4.000_4, latency_ms: 3.5, dropped: 2 };
    CueMessage::new(9, &cue, timing, detail)
}

/// Every kind of message: valid or not, for each kind of reason, with or without detail, with everything or nothing
/// known.
fn messages() -> Vec<CueMessage> {
    let fault = crate::imu::GyroFault::Empty;
    let reasons = [
        Invalid::First,
        Invalid::Interval { interval_s: 9.0, limit_s: 1.0 },
        Invalid::Gyro(fault),
        Invalid::Coverage { found: 0.1, least: 0.2 },
        Invalid::Lost,
        Invalid::Frozen,
        Invalid::Turn { found_rad_s: 1.0, most_rad_s: 0.5 },
    ];
    let invalid =
        reasons.into_iter().flat_map(|reason| [false, true].map(|detail| message(Some(reason), detail)));
    let bare = CueMessage { heading: None, threat: None, ..message(None, false) };
    invalid.chain([message(None, false), message(None, true), bare]).collect()
}

#[test]
fn a_message_has_the_values_of_its_cue() {
    let found = serde_json::to_value(message(None, true)).unwrap();
    let expected = json!({
        "frame": 9,
        "time_s": 0.12,
        "valid": true,
        "invalid_kind": null,
        "invalid": null,
        "heading": {"azimuth_deg": 0.0, "elevation_deg": 0.0, "error_deg": 0.57},
        "threat": {"azimuth_deg": -5.73, "elevation_deg": 0.0, "time_s": 1.5, "sectors": 1, "alarm": true},
        "sectors": {
            "columns": 2,
            "rows": 1,
            "azimuth_deg": [-28.65, 28.65],
            "elevation_deg": [11.46, -11.46],
            // 1 / rate, less half of the interval.
            "ttc_s": [1.98, null],
            "coverage": [0.51, 0.0],
            "ttc_early_s": [0.98, null],
            "ttc_late_s": [3.98, null],
            "nearness_rate_hz": [0.5, null],
            "divergence_hz": [1.2346, null],
            "confidence": [0.25, 0.0],
        },
        "timing": {"age_ms": 4.0, "latency_ms": 3.5, "dropped": 2},
    });
    assert_eq!(found, expected);
}

#[test]
fn an_invalid_cue_gives_no_time_and_no_rate() {
    let SectorsMessage { ttc_s, coverage, detail, .. } = message(Some(Invalid::Lost), true).sectors;
    let detail = detail.unwrap();
    for list in [ttc_s, detail.ttc_early_s, detail.ttc_late_s, detail.nearness_rate_hz, detail.divergence_hz]
    {
        assert_eq!(list, [None, None]);
    }
    assert_eq!(coverage, [0.51, 0.0]);
}

#[test]
fn what_is_written_is_read() {
    for message in messages() {
        let line = serde_json::to_string(&message).unwrap();
        assert!(!line.contains('\n'), "{line}");
        assert_eq!(serde_json::from_str::<CueMessage>(&line).unwrap(), message, "{line}");
    }
    let mut later = serde_json::to_value(message(None, false)).unwrap();
    later["added_later"] = json!([1, 2]);
    assert_eq!(serde_json::from_value::<CueMessage>(later).unwrap(), message(None, false));
}

/// Where a value breaks a schema, as far as [`CUE_SCHEMA`] uses JSON Schema: every keyword that is not known fails.
fn breach(schema: &Value, value: &Value, at: &str) -> Option<String> {
    let wrong = |what: &str| Some(format!("{at}: {what}, found {value}"));
    for (keyword, rule) in schema.as_object().unwrap() {
        let found = match keyword.as_str() {
            "$schema" | "title" | "description" => None,
            "type" => {
                let types = rule.as_array().cloned().unwrap_or_else(|| vec![rule.clone()]);
                let fits = |name: &Value| match name.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64() || value.is_i64(),
                    other => panic!("{at}: unknown type {other}"),
                };
                if types.iter().any(fits) { None } else { wrong(&format!("not of type {rule}")) }
            }
            "enum" if !rule.as_array().unwrap().contains(value) => wrong(&format!("none of {rule}")),
            "minimum" if value.as_f64().is_some_and(|v| !(v >= rule.as_f64().unwrap())) => wrong("too small"),
            "maximum" if value.as_f64().is_some_and(|v| !(v <= rule.as_f64().unwrap())) => wrong("too large"),
            "minItems" if value.as_array().is_some_and(|v| (v.len() as u64) < rule.as_u64().unwrap()) => {
                wrong("short")
            }
            "maxItems" if value.as_array().is_some_and(|v| v.len() as u64 > rule.as_u64().unwrap()) => {
                wrong("long")
            }
            "enum" | "minimum" | "maximum" | "minItems" | "maxItems" => None,
            "items" => {
                value.as_array().into_iter().flatten().find_map(|item| breach(rule, item, &format!("{at}[]")))
            }
            "required" if value.is_object() => {
                let missing =
                    rule.as_array().unwrap().iter().find(|name| value.get(name.as_str().unwrap()).is_none());
                missing.and_then(|name| wrong(&format!("{name} is missing")))
            }
            // A message may have no member that the schema does not describe.
            "properties" if value.is_object() => {
                value.as_object().unwrap().iter().find_map(|(name, member)| match rule.get(name) {
                    Some(rule) => breach(rule, member, &format!("{at}/{name}")),
                    None => wrong(&format!("{name} is not in the schema")),
                })
            }
            "required" | "properties" => None,
            other => panic!("{at}: unknown keyword {other}"),
        };
        if found.is_some() {
            return found;
        }
    }
    None
}

#[test]
fn every_message_follows_the_schema() {
    let schema: Value = serde_json::from_str(CUE_SCHEMA).unwrap();
    for message in messages() {
        let value = serde_json::to_value(&message).unwrap();
        assert_eq!(breach(&schema, &value, ""), None);
    }
    let kinds = &schema["properties"]["invalid_kind"]["enum"];
    for kind in InvalidKind::ALL {
        assert_eq!(serde_json::to_value(kind).unwrap(), kind.name());
        assert!(kinds.as_array().unwrap().contains(&kind.name().into()), "{kind:?}");
    }
    // One more for null.
    assert_eq!(kinds.as_array().unwrap().len(), InvalidKind::ALL.len() + 1);
}

#[test]
fn what_breaks_the_schema_is_found() {
    let schema: Value = serde_json::from_str(CUE_SCHEMA).unwrap();
    let good = serde_json::to_value(message(None, true)).unwrap();
    for (pointer, wrong) in [
        ("/frame", json!(-1)),
        ("/time_s", json!("0")),
        ("/invalid_kind", json!("lens")),
        ("/heading/error_deg", json!(null)),
        ("/sectors/coverage/0", json!(1.5)),
        ("/sectors/azimuth_deg", json!([1.0])),
        ("/timing", json!({"age_ms": 1.0, "latency_ms": 1.0})),
        ("/threat/further", json!(0)),
    ] {
        let mut value = good.clone();
        match value.pointer_mut(pointer) {
            Some(place) => *place = wrong,
            None => value["threat"]["further"] = wrong,
        }
        assert!(breach(&schema, &value, "").is_some(), "{pointer}");
    }
}

#[test]
fn numbers_are_short_and_never_minus_zero() {
    assert_eq!(round(1.234_567, 3), 1.235);
    assert!(round(-1e-9, 3).is_sign_positive());
    assert!(round(f64::NAN, 3).is_nan());
}
