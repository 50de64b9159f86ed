//! A score to JSON and back.

use serde_json::{Value, json};

use crate::eval::{Bad, Outliers, Score};

/// All figures of a score; shares are 0 to 1, an undefined figure is null.
pub fn to_json(score: &Score) -> Value {
    let Score { known, estimated, bad, average, rms, a50, a90, a99, d1 } = score;
    let shares = |of_known: f64, of_estimated: f64| json!({ "of_all": of_known, "of_estimated": of_estimated });
    let bad = bad.iter().map(|&Bad { threshold, of_known, of_estimated }| {
        let mut value = shares(of_known, of_estimated);
        value["above_px"] = threshold.into();
        value
    });
    json!({
        "pixels": known,
        "estimated": estimated,
        "density": score.coverage(),
        "bad": bad.collect::<Vec<_>>(),
        "d1": shares(d1.of_known, d1.of_estimated),
        "average_error_px": average,
        "rms_error_px": rms,
        "a50_px": a50,
        "a90_px": a90,
        "a99_px": a99,
    })
}

/// Reads a score that [`to_json`] wrote; `None` if a figure is missing.
pub fn from_json(value: &Value) -> Option<Score> {
    let count = |name: &str| usize::try_from(value[name].as_u64()?).ok();
    let bad = value["bad"].as_array()?.iter().map(|bad| {
        let (of_known, of_estimated) = shares(bad)?;
        Some(Bad { threshold: bad["above_px"].as_f64()? as f32, of_known, of_estimated })
    });
    let (of_known, of_estimated) = shares(&value["d1"])?;
    Some(Score {
        known: count("pixels")?,
        estimated: count("estimated")?,
        bad: bad.collect::<Option<_>>()?,
        average: number(value, "average_error_px")?,
        rms: number(value, "rms_error_px")?,
        a50: number(value, "a50_px")?,
        a90: number(value, "a90_px")?,
        a99: number(value, "a99_px")?,
        d1: Outliers { of_known, of_estimated },
    })
}

fn shares(value: &Value) -> Option<(f64, f64)> {
    Some((number(value, "of_all")?, number(value, "of_estimated")?))
}

fn number(value: &Value, name: &str) -> Option<f64> {
    match value.get(name)? {
        Value::Null => Some(f64::NAN),
        number => number.as_f64(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{eval::score_pixels, image::Plane};

    #[test]
    fn every_bit_comes_back() {
        let map = Plane::from_fn((17, 3), |x, y| if x == 4 { f32::NAN } else { (x * x * 31 % 19 + y) as f32 / 3.0 });
        let found = score_pixels(&map, &Plane::filled((17, 3), 2.2), None, &[0.5, 0.1]).unwrap();
        let text = to_json(&found).to_string();
        assert_eq!(from_json(&serde_json::from_str(&text).unwrap()).unwrap(), found);

        let empty = score_pixels(&Plane::filled((2, 2), f32::NAN), &Plane::filled((2, 2), 1.0), None, &[1.0]).unwrap();
        let value = to_json(&empty);
        assert_eq!((&value["average_error_px"], &value["bad"][0]["of_all"]), (&Value::Null, &json!(1.0)));
        assert!(from_json(&value).unwrap().a50.is_nan());
        for name in ["pixels", "bad", "d1", "a99_px"] {
            let mut value = to_json(&found);
            value.as_object_mut().unwrap().remove(name);
            assert_eq!(from_json(&value), None, "{name}");
        }
    }
}
