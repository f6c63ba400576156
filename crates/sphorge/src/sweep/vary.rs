//! A key of a deck and the values it takes.

use crate::deck::quantity_of_key;

/// A key that is varied.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// Path of the key, as `--set` takes it.
    pub key: String,
    /// Values, as `--set` takes them.
    pub values: Vec<String>,
}

impl Varied {
    /// Reads `KEY=VALUE,VALUE,...`. Commas in brackets or quotation marks are parts of values.
    ///
    /// # Errors
    /// What to write.
    pub fn read(text: &str) -> Result<Self, String> {
        let (key, values) =
            text.split_once('=').filter(|(key, _)| !key.trim().is_empty()).ok_or_else(|| HOW.to_owned())?;
        let values = split(values)?;
        if values.iter().any(String::is_empty) {
            return Err(format!("a value is missing between two commas; {HOW}"));
        }
        Ok(Self { key: key.trim().to_owned(), values })
    }

    /// The values as numbers, SI, and their unit, if all of them are quantities of one kind.
    pub fn numbers(&self) -> Option<(Vec<f64>, &'static str)> {
        let read: Option<Vec<_>> = self.values.iter().map(|value| quantity_of_key(&self.key, value)).collect();
        let read = read?;
        let unit = read.first()?.1;
        read.iter().all(|(_, other)| *other == unit).then(|| (read.into_iter().map(|(x, _)| x).collect(), unit))
    }
}

/// How values are written.
const HOW: &str = "write the key, `=` and its values with commas between them: `particles.spacing=\"0.6 mm,0.3 mm\"`";

/// Splits at commas outside of brackets and quotation marks.
fn split(text: &str) -> Result<Vec<String>, String> {
    let mut parts = vec![String::new()];
    let mut depth = 0usize;
    let mut quote = None;
    for c in text.chars() {
        match (quote, c) {
            (None, ',') if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), _) if c == open => quote = None,
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => {
                depth = depth.checked_sub(1).ok_or_else(|| format!("`{c}` closes nothing; {HOW}"))?;
            }
            _ => {}
        }
        if let Some(last) = parts.last_mut() {
            last.push(c);
        }
    }
    match (quote, depth) {
        (Some(quote), _) => Err(format!("a quotation mark {quote} is not closed; {HOW}")),
        (None, 1..) => Err(format!("a bracket is not closed; {HOW}")),
        (None, 0) => Ok(parts.into_iter().map(|part| part.trim().to_owned()).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_apart_by_commas_that_are_not_inside_of_them() {
        let values = |text: &str| Varied::read(text).map(|varied| varied.values);
        assert_eq!(values("particles.spacing=0.6 mm, 0.3 mm").unwrap(), ["0.6 mm", "0.3 mm"]);
        assert_eq!(values("a = \"1,2\",3").unwrap(), ["\"1,2\"", "3"]);
        assert_eq!(values("v=[\"0 m/s\",\"1 m/s\"],[0,2]").unwrap(), ["[\"0 m/s\",\"1 m/s\"]", "[0,2]"]);
        assert_eq!(values("s={ adaptive = { a = 1, b = 2 } },skin").unwrap().len(), 2);
        for (text, told) in [
            ("particles.spacing", "`=`"),
            ("=1,2", "`=`"),
            ("a=1,,2", "missing"),
            ("a=", "missing"),
            ("a=[1,2", "bracket"),
            ("a=1]", "closes nothing"),
            ("a=\"1", "quotation"),
        ] {
            let error = Varied::read(text).unwrap_err();
            assert!(error.contains(told), "{text}: {error}");
        }
    }

    #[test]
    fn values_of_one_kind_are_numbers() {
        let numbers = |text: &str| Varied::read(text).unwrap().numbers();
        let (lengths, unit) = numbers("particles.spacing=0.6 mm,0.0003").unwrap();
        assert!((lengths[0] - 0.6e-3).abs() < 1e-18 && lengths[1] == 0.0003 && unit == "m", "{lengths:?}");
        assert_eq!(numbers("particles.spacing=0.6 mm,wide"), None);
        assert_eq!(numbers("search=skin,every-step"), None);
    }
}
