//! What changed between two files of one kind, key by key.

use toml::Value;

/// Changes reported; more are only counted.
const TOLD: usize = 6;

/// The keys in which two TOML texts differ, a line each: before and now.
pub fn list(before: &str, now: &str) -> String {
    let mut lines = Vec::new();
    let bits = |text: &str| {
        text.lines()
            .next()
            .unwrap_or_default()
            .trim_start_matches("# ")
            .to_string()
    };
    if bits(before) != bits(now) {
        lines.push(format!(
            "  arithmetic: {} before, {} now",
            bits(before),
            bits(now)
        ));
    }
    let parsed = |text: &str| toml::from_str::<toml::Table>(text).map(Value::Table);
    match (parsed(before), parsed(now)) {
        (Ok(before), Ok(now)) => compare("", Some(&before), Some(&now), &mut lines),
        _ => lines.push("  one of the two is not TOML".into()),
    }
    let more = lines.len().saturating_sub(TOLD);
    lines.truncate(TOLD);
    if more > 0 {
        lines.push(format!("  and {more} more"));
    }
    lines.join("\n")
}

fn compare(key: &str, before: Option<&Value>, now: Option<&Value>, lines: &mut Vec<String>) {
    if before == now {
        return;
    }
    match (before, now) {
        (Some(Value::Table(a)), Some(Value::Table(b))) => {
            let mut keys: Vec<&String> = a.keys().chain(b.keys()).collect();
            keys.sort();
            keys.dedup();
            for inner in keys {
                let path = if key.is_empty() {
                    inner.clone()
                } else {
                    format!("{key}.{inner}")
                };
                compare(&path, a.get(inner), b.get(inner), lines);
            }
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) if holds_tables(a) || holds_tables(b) => {
            for k in 0..a.len().max(b.len()) {
                compare(&format!("{key}[{}]", k + 1), a.get(k), b.get(k), lines);
            }
        }
        _ => {
            let word = |value: Option<&Value>| match value {
                None => "not there".to_string(),
                Some(Value::Table(_)) => "there".into(),
                Some(value) => value.to_string(),
            };
            lines.push(format!(
                "  {key}: {} before, {} now",
                word(before),
                word(now)
            ));
        }
    }
}

fn holds_tables(list: &[Value]) -> bool {
    list.iter().any(|value| matches!(value, Value::Table(_)))
}
