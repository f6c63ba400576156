//! Words and names a user may have meant.

/// Longest word that is compared with others, and most others: the time goes with the product.
const LONGEST_WORD: usize = 100;
const MOST_OPTIONS: usize = 1000;

/// The option most like `word`, if one is near enough to be meant.
pub(crate) fn nearest<'a>(word: &str, options: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > LONGEST_WORD {
        return None;
    }
    let folded = fold(word);
    let terms = terms(&folded);
    let mut best = None;
    for option in options.into_iter().take(MOST_OPTIONS) {
        if terms.contains(&option) {
            return Some(option);
        }
        let known = fold(option);
        let mut score = strsim::normalized_damerau_levenshtein(&folded, &known);
        if folded.len() >= 3 && (known.starts_with(&folded) || folded.starts_with(&known) || known.ends_with(&folded)) {
            score = score.max(0.6);
        }
        if score >= 0.5 && best.is_none_or(|(s, _)| score > s) {
            best = Some((score, option));
        }
    }
    best.map(|(_, option)| option)
}

/// What deck keys call that which books and other programs call by a word, in lower case.
fn terms(word: &str) -> &'static [&'static str] {
    match word {
        "e" | "elastic-modulus" | "youngs-modulus" | "young" => &["young-modulus"],
        "g" => &["shear-modulus"],
        "nu" | "poisson" | "poissons-ratio" => &["poisson-ratio"],
        "rho" | "rho0" | "rho-0" => &["density"],
        "c0" | "c-0" => &["sound-speed"],
        "s" => &["shock-slope"],
        "gamma" | "gamma0" => &["gruneisen"],
        "eos" => &["equation-of-state"],
        "cp" | "heat-capacity" => &["specific-heat"],
        "linear-hardening" | "isotropic-hardening" | "elastic-plastic" | "plastic-kinematic" => &["bilinear"],
        "plastic" | "von-mises" | "j2" => &["perfectly-plastic"],
        "jc" => &["johnson-cook"],
        _ => &[],
    }
}

/// Shortest part of a name that is told from others.
const SHORTEST_PART: usize = 3;
/// Most names that are suggested: of more, none is meant rather than another.
const MOST_NAMES: usize = 10;

/// The names that may be meant by `word`, all of them equally like it: one that is like it as a whole, or those with parts like all of
/// its own, in any order: `coper-ofhc` is `ofhc-copper`, and `copper` all coppers.
pub fn like<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    if word.len() > LONGEST_WORD {
        return Vec::new();
    }
    let folded = fold(word);
    let mut best = 0.0;
    let mut found: Vec<&str> = Vec::new();
    for name in names.into_iter().take(MOST_OPTIONS) {
        let likeness = likeness_of_names(&folded, &fold(name));
        if likeness > best {
            best = likeness;
            found.clear();
        }
        if likeness > 0.0 && likeness == best && !found.contains(&name) {
            found.push(name);
        }
    }
    if found.len() > MOST_NAMES { Vec::new() } else { found }
}

/// `did you mean ...? `, if there is something that may be meant, else nothing.
pub fn did_you_mean<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names = names.into_iter().peekable();
    if names.peek().is_none() { String::new() } else { format!("did you mean {}? ", listed(names, "or")) }
}

/// As names are compared.
fn fold(name: &str) -> String {
    name.to_lowercase().replace(['_', ' '], "-")
}

/// From 0, for a stranger, to 1.
fn likeness_of_names(word: &str, name: &str) -> f64 {
    let parts = |text| str::split(text, '-').filter(|part| !part.is_empty());
    let has_digits = |part: &&str| part.bytes().any(|byte| byte.is_ascii_digit());
    // Alloys and cases that differ in their number are others.
    let is_number_known = |number| parts(name).any(|part| strsim::damerau_levenshtein(number, part) <= 1);
    if !parts(word).filter(has_digits).all(is_number_known) {
        return 0.0;
    }
    let whole = strsim::normalized_damerau_levenshtein(word, name);
    let whole = if whole >= 0.7 || (whole >= 0.5 && word.len().min(name.len()) > 4) { whole } else { 0.0 };
    let of_part = |part: &str| {
        let long = parts(name).filter(|other| part == *other || part.len().min(other.len()) >= SHORTEST_PART);
        let each = long.map(|other| strsim::normalized_damerau_levenshtein(part, other));
        each.filter(|likeness| *likeness >= 0.65).fold(0.0, f64::max)
    };
    let likenesses: Vec<f64> = parts(word).map(of_part).collect();
    let is_like = !likenesses.is_empty() && likenesses.iter().all(|likeness| *likeness > 0.0);
    // Less than one that is as like as a whole.
    let by_parts = if is_like { 0.95 * likenesses.iter().sum::<f64>() / likenesses.len() as f64 } else { 0.0 };
    whole.max(by_parts)
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
    let near = did_you_mean(like(word, options.clone()));
    let all = match count {
        0 => format!("the deck has no {what}"),
        1..=30 => format!("there {} {}", if count == 1 { "is" } else { "are" }, listed(options, "and")),
        _ => String::new(),
    };
    (near + &all).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_knows_the_words_of_others() {
        let strengths = ["none", "elastic", "perfectly-plastic", "bilinear", "johnson-cook"];
        let pairs = [("elastic-plastic", "bilinear"), ("plastic", "perfectly-plastic"), ("JC", "johnson-cook")];
        for (word, meant) in
            pairs.into_iter().chain([("linear-hardening", "bilinear"), ("von_mises", "perfectly-plastic")])
        {
            assert_eq!(nearest(word, strengths), Some(meant));
        }
        let constants = ["density", "young-modulus", "shear-modulus", "poisson-ratio", "specific-heat"];
        for (word, meant) in
            [("elastic-modulus", "young-modulus"), ("E", "young-modulus"), ("nu", "poisson-ratio"), ("rho", "density")]
        {
            assert_eq!(nearest(word, constants), Some(meant));
        }
        // Only where there is one.
        assert_eq!(nearest("gamma", constants), None);
    }

    #[test]
    fn nearest_finds_slips_and_gives_up_on_strangers() {
        let keys = ["spacing", "smoothing", "placement"];
        assert_eq!(nearest("spaceing", keys), Some("spacing"));
        assert_eq!(nearest("Spacing", keys), Some("spacing"));
        assert_eq!(nearest("zzz", keys), None);
        assert_eq!(nearest("", keys), None);
        // Fields are written with `_`.
        assert_eq!(nearest("mises_stress", ["von_mises_stress", "mean_stress_x"]), Some("von_mises_stress"));
    }

    #[test]
    fn names_are_found_by_their_parts() {
        let metals =
            ["ofhc-copper", "copper-shock", "4340-steel", "1006-steel", "6061-t6-aluminium", "ti-6al-4v", "armco-iron"];
        let coppers = ["ofhc-copper", "copper-shock"];
        for word in ["copr", "copper", "Coper", "coppr"] {
            assert_eq!(like(word, metals), coppers, "{word}");
        }
        assert_eq!(like("steal", metals), ["4340-steel", "1006-steel"]);
        assert_eq!(like("ofhc-coper", metals), ["ofhc-copper"]);
        assert_eq!(like("coper_ofhc", metals), ["ofhc-copper"]);
        assert_eq!(like("Steel 1006", metals), ["1006-steel"]);
        assert_eq!(like("aluminum", metals), ["6061-t6-aluminium"]);
        assert_eq!(like("606-t6-aluminum", metals), ["6061-t6-aluminium"]);
        // Other metals, and other alloys.
        for word in [
            "tin",
            "zinc",
            "lead",
            "gold",
            "silver",
            "brine",
            "316-steel",
            "7075-t6-aluminium",
            "x",
            "-",
            "",
            "unobtainium",
        ] {
            assert_eq!(like(word, metals), [""; 0], "{word}");
        }
    }

    #[test]
    fn what_is_like_too_many_names_is_like_none() {
        let names: Vec<String> = (0..30).map(|k| format!("ball-{k}")).collect();
        assert_eq!(like("bal", names.iter().map(String::as_str)), [""; 0]);
        assert_eq!(like("ball3", names.iter().map(String::as_str)), ["ball-3"]);
    }
}
