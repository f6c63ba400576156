//! Words and names a user may have meant.

/// Longest word that is compared with others, and most others: the time goes with the product.
const LONGEST_WORD: usize = 100;
const MOST_OPTIONS: usize = 1000;

/// The option most like `word`, if one is near enough to be meant.
pub(crate) fn nearest<'a>(word: &str, options: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > LONGEST_WORD {
        return None;
    }
    let folded = word.to_lowercase().replace(['_', ' '], "-");
    let mut best = None;
    for option in options.into_iter().take(MOST_OPTIONS) {
        let mut score = strsim::normalized_damerau_levenshtein(&folded, &option.to_lowercase());
        if folded.len() >= 3 && (option.starts_with(&folded) || folded.starts_with(option) || option.ends_with(&folded))
        {
            score = score.max(0.6);
        }
        if score >= 0.5 && best.is_none_or(|(s, _)| score > s) {
            best = Some((score, option));
        }
    }
    best.map(|(_, option)| option)
}

/// `a`, `b` or `c`, quoted for people.
pub(crate) fn listed<'a>(options: impl IntoIterator<Item = &'a str>, joint: &str) -> String {
    let quoted: Vec<String> = options.into_iter().map(|o| format!("`{o}`")).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [head @ .., last] => format!("{} {joint} {last}", head.join(", ")),
    }
}

/// The help of a name that is not among the options: the nearest one, and all of them if they are few.
pub(crate) fn suggest<'a>(word: &str, options: impl IntoIterator<Item = &'a str> + Clone, what: &str) -> String {
    let count = options.clone().into_iter().count();
    let near = nearest(word, options.clone()).map(|n| format!("did you mean `{n}`? "));
    let all = match count {
        0 => format!("The deck has no {what}."),
        1..=30 => format!("There {} {}.", if count == 1 { "is" } else { "are" }, listed(options, "and")),
        _ => String::new(),
    };
    (near.unwrap_or_default() + &all).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_slips_and_gives_up_on_strangers() {
        let keys = ["spacing", "smoothing", "placement"];
        assert_eq!(nearest("spaceing", keys), Some("spacing"));
        assert_eq!(nearest("Spacing", keys), Some("spacing"));
        assert_eq!(nearest("zzz", keys), None);
        assert_eq!(nearest("", keys), None);
    }
}
