//! The files of the page, which are in the program. The scripts are plain ones in this order, not modules, so that one file can hold them all.

/// The page, in which [`STYLE`] and the scripts are named.
pub(super) const PAGE: &str = include_str!("page/index.html");
pub(super) const STYLE: (&str, &str) = ("style.css", include_str!("page/style.css"));
pub(super) const SCRIPTS: [(&str, &str); 21] = [
    ("numbers.js", include_str!("page/numbers.js")),
    ("units.js", include_str!("page/units.js")),
    ("vectors.js", include_str!("page/vectors.js")),
    ("colors.js", include_str!("page/colors.js")),
    ("live.js", include_str!("page/live.js")),
    ("embedded.js", include_str!("page/embedded.js")),
    ("store.js", include_str!("page/store.js")),
    ("shaders.js", include_str!("page/shaders.js")),
    ("graphics.js", include_str!("page/graphics.js")),
    ("camera.js", include_str!("page/camera.js")),
    ("cells.js", include_str!("page/cells.js")),
    ("walls.js", include_str!("page/walls.js")),
    ("particles.js", include_str!("page/particles.js")),
    ("colorbar.js", include_str!("page/colorbar.js")),
    ("chart.js", include_str!("page/chart.js")),
    ("panel.js", include_str!("page/panel.js")),
    ("pointer.js", include_str!("page/pointer.js")),
    ("controls.js", include_str!("page/controls.js")),
    ("timeline.js", include_str!("page/timeline.js")),
    ("picked.js", include_str!("page/picked.js")),
    ("main.js", include_str!("page/main.js")),
];

/// What stands in the page for the style and the scripts.
const STYLE_MARK: &str = "<!--style-->";
const SCRIPTS_MARK: &str = "<!--scripts-->";

/// The page that asks for its parts.
pub(super) fn page_of_parts() -> String {
    let style = format!("<link rel=\"stylesheet\" href=\"{}\">", STYLE.0);
    let scripts = SCRIPTS.map(|(name, _)| format!("<script src=\"{name}\"></script>\n")).concat();
    PAGE.replace(STYLE_MARK, &style).replace(SCRIPTS_MARK, &scripts)
}

/// The page with all its parts, and with `data` before the scripts.
pub(super) fn page_with_parts(data: &str) -> String {
    // Nothing is fetched, and no other script runs.
    let policy = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\">";
    let style = format!("{policy}\n<style>\n{}</style>", STYLE.1);
    let scripts = SCRIPTS.map(|(_, text)| format!("<script>\n{text}</script>\n")).concat();
    PAGE.replace(STYLE_MARK, &style).replace(SCRIPTS_MARK, &format!("{data}{scripts}"))
}

/// A part by its name, and what it is.
pub(super) fn part(name: &str) -> Option<(String, &'static str)> {
    if name == "index.html" {
        return Some((page_of_parts(), "text/html; charset=utf-8"));
    }
    if name == STYLE.0 {
        return Some((STYLE.1.to_owned(), "text/css; charset=utf-8"));
    }
    let (_, text) = SCRIPTS.iter().find(|(own, _)| *own == name)?;
    Some(((*text).to_owned(), "text/javascript; charset=utf-8"))
}

/// JSON in a script of a page, where nothing may end the script.
pub(super) fn json_in_page(json: &str) -> String {
    json.replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_each_part_once_and_nothing_ends_a_script_early() {
        let page = page_of_parts();
        assert!(!page.contains("<!--"), "a mark is left");
        for (name, text) in SCRIPTS {
            assert_eq!(page.matches(&format!("src=\"{name}\"")).count(), 1, "{name}");
            assert!(text.starts_with("// ") && text.contains("\n\"use strict\";\n"), "{name}");
            assert!(!text.to_lowercase().contains("</script"), "{name}");
        }
        let whole = page_with_parts("<script type=\"application/json\" id=\"data\">{}</script>");
        assert!(!whole.contains(" src=") && !whole.contains("<link rel=\"stylesheet\""));
        assert_eq!(json_in_page("{\"a\":\"</script>\u{2028}\"}"), "{\"a\":\"\\u003c/script>\\u2028\"}");
    }

    #[test]
    fn parts_are_found_by_their_names_alone() {
        assert!(part("index.html").is_some() && part("style.css").is_some() && part("main.js").is_some());
        assert!(part("").is_none() && part("page/main.js").is_none() && part("deck.toml").is_none());
    }
}
