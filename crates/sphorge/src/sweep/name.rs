//! Names of the folders of a sweep: what was set, in letters that every file system takes.

/// Longest name; longer ones end with a sum.
const LONGEST: usize = 120;

/// The name of a run with these keys and values.
pub(super) fn of<'a>(set: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let mut name = Vec::new();
    let mut exactly = String::new();
    for (key, value) in set {
        name.push(format!("{}={}", plain(key), plain(value)));
        exactly += &format!("{key}={value}\n");
    }
    let name = name.join(",");
    // Texts of which nothing may be left are told apart whatever is run with them.
    if name.len() <= LONGEST && exactly.is_ascii() { name } else { told_apart(&name, &exactly) }
}

/// The same name, told from others that look like it.
pub(super) fn told_apart(name: &str, exactly: &str) -> String {
    // All bytes of a name are ASCII.
    format!("{}-{:08x}", &name[..name.len().min(LONGEST - 9)], crc32fast::hash(exactly.as_bytes()))
}

/// Letters, digits and what stands in numbers; blanks and quotation marks are left out, and a run of anything else becomes one `_`.
fn plain(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars().filter(|c| !c.is_whitespace() && !matches!(c, '"' | '\'')) {
        let fits = c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+' | '_');
        if fits {
            shown.push(c);
        } else if !shown.ends_with('_') {
            shown.push('_');
        }
    }
    shown.trim_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_and_of_letters_that_file_systems_take() {
        let set = [("particles.spacing", "\"0.6 mm\""), ("body.bar.velocity.1", "-150 m/s"), ("a", "[0, 1]")];
        assert_eq!(of(set.into_iter()), "particles.spacing=0.6mm,body.bar.velocity.1=-150m_s,a=0_1");
        let long = of([("a", "../\u{202e}é"), ("b", "x".repeat(500).as_str())].into_iter());
        assert!(long.starts_with("a=.._,b=xxx") || long.starts_with("a=..,b=xxx"), "{long}");
        assert_eq!(long.len(), LONGEST);
        assert_ne!(long, of([("a", "../\u{202e}é"), ("b", "x".repeat(501).as_str())].into_iter()));
        assert_ne!(told_apart("a=1", "1 m"), told_apart("a=1", "1 s"));
        let letter = |letter: &str| of([("title", letter)].into_iter());
        assert!(letter("é") != letter("ü") && letter("é").starts_with("title=-"), "{}", letter("é"));
    }
}
