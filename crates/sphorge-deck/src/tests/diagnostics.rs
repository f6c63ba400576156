//! What a user is told of each kind of fault: the kind, the place, the words.

use super::super::*;
use super::{FLAVOUR, changed};
use sphorge_engine::geometry::MAX_PARTICLES;
use sphorge_engine::model::BodyContact;

/// What is said of a deck with faults.
#[track_caller]
fn refused(deck: &str) -> DeckReport {
    match load_text("deck.toml", deck, &[]) {
        Ok(_) => panic!("no fault is found in\n{deck}"),
        Err(report) => report,
    }
}

/// The only fault of a deck.
#[track_caller]
fn fault(deck: &str) -> Problem {
    let report = refused(deck);
    assert_eq!(report.problems().len(), 1, "{:?}", report.problems());
    report.problems()[0].clone()
}

/// Checks kind, marked text, message and help of the only fault of the deck with `old` made `new`.
#[track_caller]
fn told(old: &str, new: &str, code: &str, marked: &str, message: &str, help: &str) {
    let deck = changed(old, new);
    let problem = fault(&deck);
    assert_eq!(problem.code(), code, "{problem}");
    let at = problem.labels()[0].0.clone();
    assert_eq!(&deck[at.clone()], marked, "{problem}");
    assert_eq!(problem.line(), Some(1 + deck[..at.start].matches('\n').count()));
    assert!(problem.to_string().contains(message), "message: {problem}");
    let found = problem.help().unwrap_or_default();
    assert!(found.contains(help), "help: {found}");
}

#[test]
fn unknown_keys_name_the_nearest_or_where_they_belong() {
    told("smoothing = 1.2", "smothing = 1.2", "unknown-key", "smothing", "in `particles`", "did you mean `smoothing`?");
    told("search =", "courant = 0.2\nsearch =", "unknown-key", "courant", "at the top", "`courant` belongs to `time`");
    told("{ box =", "{ boks =", "unknown-key", "boks", "in `body.shape`", "did you mean `box`?");
    let law = "[material.x]\nbase = \"armco-iron\"\nstrength = { johnson-cook = { a = 1 } }\n[time]";
    told("[time]", law, "unknown-key", "a", "`material.x.strength.johnson-cook`", "did you mean `A`?");
}

#[test]
fn text_that_would_move_the_cursor_of_a_terminal_is_refused() {
    let (title, escape) = ("\"Taylor impact of an Armco iron plate (Patiño et al., test 2)\"", "\"bar \\u001B[2J\"");
    told(title, escape, "control-character", escape, "without control characters", "");
}

#[test]
fn wrong_units_name_the_dimension_and_show_examples() {
    told("\"-200 m/s\"", "\"-200 mm\"", "wrong-quantity", "mm", "expected a velocity (m/s), found a length", "200 m/s");
    told("\"60 us\"", "\"60 usec\"", "wrong-quantity", "usec", "unknown unit `usec`", "a time (s)");
    told("\"0.3 mm\"", "true", "wrong-type", "true", "expected a length", "0.3 mm");
}

#[test]
fn values_out_of_range_say_the_range() {
    let negative = "[material.x]\nbase = \"armco-iron\"\ndensity = \"-7890 kg/m^3\"\n[time]";
    told("[time]", negative, "out-of-range", "\"-7890 kg/m^3\"", "the density must be above zero", "");
    told("1.2", "nan", "not-finite", "nan", "expected a finite number", "");
    told("1.2", "-inf", "not-finite", "-inf", "expected a finite number", "");
    told("\"60 us\"", "inf", "not-finite", "inf", "expected a finite time", "60 us");
    told("\"3.8 mm\"", "\"-4 mm\"", "out-of-range", "\"-4 mm\"", "along x the box ends where it begins", "swap");
}

#[test]
fn bodies_in_one_place_are_both_named() {
    let second = "[[body]]\nname = \"block\"\nmaterial = \"armco-iron\"\n\
                  shape = { box = { min = [\"3.6 mm\", \"1 mm\"], max = [\"6 mm\", \"2 mm\"] } }\n\n[[wall]]";
    let message = "bodies `bar` and `block` overlap";
    told("[[wall]]", second, "overlap", "\"block\"", message, "move them apart");
    // Side by side, face on face, they do not overlap, though neither length is a multiple of the spacing.
    let beside = second.replace("3.6 mm", "3.8 mm");
    assert!(load_text("deck", &changed("[[wall]]", &beside), &[]).is_ok());
}

#[test]
fn of_many_bodies_in_one_place_the_first_overlaps_are_told() {
    let body = |k: usize| {
        format!(
            "[[body]]\nname = \"b{k}\"\nmaterial = \"armco-iron\"\nshape = {{ box = {{ min = [0, 0], max = [\"3 mm\", \"3 mm\"] }} }}\n"
        )
    };
    let deck = changed("[[wall]]", &format!("{}\n[[wall]]", (0..30).map(body).collect::<String>()));
    assert_eq!(refused(&deck).problems().len(), 20);
}

#[test]
fn a_body_beyond_the_digits_of_its_coordinates_is_refused() {
    let block = "min = [\"1e9 m\", \"0 mm\"], max = [\"1.000000001e9 m\", \"25.46 mm\"]";
    let deck = changed("min = [\"-3.8 mm\", \"0 mm\"], max = [\"3.8 mm\", \"25.46 mm\"]", block);
    assert!(refused(&deck).problems().iter().any(|problem| problem.code() == "too-far"), "{:?}", refused(&deck));
}

#[test]
fn what_holds_no_particles_is_named() {
    let thin = "max = [\"-3.6 mm\", \"25.46 mm\"]";
    told(
        "max = [\"3.8 mm\", \"25.46 mm\"]",
        thin,
        "empty-body",
        "\"bar\"",
        "body `bar` contains no particles",
        "at most 0.2000 mm",
    );
    let region = "[[region]]\nname = \"top\"\nshape = { box = { min = [\"0 mm\", \"26 mm\"], max = [\"1 mm\", \"27 mm\"] } }\n[[wall]]";
    told("[[wall]]", region, "empty-region", "\"top\"", "region `top` contains no particles", "");
    told(
        "[[wall]]",
        "[[region]]\nname = \"all\"\n[[wall]]",
        "empty-region",
        "\"all\"",
        "needs a `body`, a `shape`",
        "",
    );
}

#[test]
fn materials_that_are_unknown_or_incomplete_say_what_to_add() {
    told(
        "\"armco-iron\"",
        "\"armco-irn\"",
        "unknown-material",
        "\"armco-irn\"",
        "`armco-irn`",
        "did you mean `armco-iron`?",
    );
    let shear = "has no `shear-modulus`, which `johnson-cook` needs";
    let lacks_shear = "[material.x]\ndensity = 7850\nequation-of-state = { mie-gruneisen = { sound-speed = 4600, shock-slope = 1.5, \
                       gruneisen = 2 } }\nstrength = { johnson-cook = { A = 1e8, B = 0, n = 1, C = 0, m = 1, melting-temperature = 1800 } }\n";
    let deck = changed("[time]", &format!("{lacks_shear}[time]")).replace("\"armco-iron\"", "\"x\"");
    let problem = fault(&deck);
    assert_eq!(problem.to_string(), format!("material `x` {shear}"));
    assert!(problem.help().unwrap().contains("[material.x]"), "{:?}", problem.help());
    let report = refused(&changed("\"armco-iron\"", "\"1006-steel\""));
    let helps: Vec<_> = report.problems().iter().map(|p| p.help().unwrap_or_default().to_owned()).collect();
    assert!(
        helps.len() == 2 && helps.iter().all(|h| h.contains("[material.1006-steel]; such a table starts")),
        "{helps:?}"
    );
    let own = "[material.own]\ndensity = 1000\nyoung-modulus = \"1 GPa\"\npoisson-ratio = 0.3\nspecific-heat = 400\n\
               strength = { johnson-cook = { A = \"1 MPa\", B = 0, n = 1, C = 0, m = 1 } }\n[time]";
    let deck = changed("[time]", own).replace("material = \"armco-iron\"", "material = \"own\"");
    let problem = fault(&deck);
    assert_eq!(problem.to_string(), "material `own` has no `melting-temperature`, which `johnson-cook` needs");
    assert!(problem.help().unwrap().contains("[material.own.strength.johnson-cook]"), "{:?}", problem.help());
    let law = "strength = { jonson-cook = {} }";
    let deck = changed("[time]", &format!("[material.x]\nbase = \"armco-iron\"\n{law}\n[time]"));
    assert!(fault(&deck).help().unwrap().contains("did you mean `johnson-cook`?"));
    let circle = "[material.a]\nbase = \"b\"\n[material.b]\nbase = \"a\"\n[time]";
    let report = refused(&changed("[time]", circle));
    assert!(report.problems().iter().all(|p| p.code() == "circular-base"), "{report}");
}

#[test]
fn what_a_deck_gives_and_nothing_uses_is_told() {
    // A slip in `--set` makes a material of its own, which changes nothing.
    let set = |key: &str| load_text("deck.toml", FLAVOUR, &[(key.to_owned(), "900 MPa".to_owned())]);
    let report = set("material.armco-irn.strength.johnson-cook.A").err().unwrap();
    let problem = &report.problems()[0];
    assert_eq!((report.problems().len(), problem.code()), (1, "unknown-name"), "{report}");
    assert!(problem.help().unwrap().contains("did you mean `armco-iron`?"), "{problem}");
    assert!(set("material.armco-iron.strength.johnson-cook.A").is_ok());
    // Whatever line they have: lines move.
    let notes = |old: &str, new: &str| -> Vec<String> {
        let notes = load_text("deck.toml", &changed(old, new), &[]).unwrap().all_notes();
        let bare = |note: &String| {
            note.split_once(": ").filter(|(line, _)| line.starts_with("line ")).map(|(_, rest)| rest.to_owned())
        };
        notes.iter().map(|note| bare(note).unwrap_or_else(|| note.clone())).collect()
    };
    let before = notes("[time]", "\n[time]");
    let told = |new: &str| -> Vec<String> {
        notes("[time]", &format!("{new}\n[time]")).into_iter().filter(|note| !before.contains(note)).collect()
    };
    // One that is whole, or of the catalogue, may wait for a body.
    let [note] = &told("[material.armco-irn]\nbase = \"armco-iron\"")[..] else { panic!() };
    assert!(
        note.contains("no body uses material `armco-irn`") && note.contains("did you mean `armco-iron`?"),
        "{note}"
    );
    let [note] = &told("[material.4340-steel]\ndensity = 7800")[..] else { panic!() };
    assert!(note.contains("`4340-steel`") && note.contains("bodies use `armco-iron`"), "{note}");
    // One that another is based on is used by it.
    let based = changed("\"armco-iron\"", "\"mine\"");
    let deck =
        based.replacen("[time]", "[material.mine]\nbase = \"half\"\n[material.half]\nbase = \"armco-iron\"\n[time]", 1);
    assert!(load_text("deck.toml", &deck, &[]).unwrap().all_notes().iter().all(|note| !note.contains("no body uses")));
    // Where a body names none that there is, that is the slip.
    let deck = changed("\"armco-iron\"", "\"min\"").replacen("[time]", "[material.mine]\ndensity = 1\n[time]", 1);
    assert_eq!(fault(&deck).code(), "unknown-material");
    let region = "[[region]]\nname = \"rim\"\nbody = \"bar\"\n";
    let [note] = &told(region)[..] else { panic!() };
    assert!(note.contains("names region `rim`"), "{note}");
    assert_eq!(
        told(&format!(
            "{region}[[measure]]\nname = \"hot\"\nmaximum = {{ region = \"rim\", field = \"temperature\" }}\n"
        )),
        [""; 0]
    );
}

#[test]
fn too_many_particles_are_counted_before_they_are_made() {
    let problem = fault(&changed("\"0.3 mm\"", "\"10 nm\""));
    assert_eq!(problem.code(), "too-many-particles");
    assert!(problem.to_string().contains("about 1.93e12 particles"), "{problem}");
    assert!(problem.to_string().contains("GB"));
    assert!(problem.help().unwrap().contains("gives a million"));
}

#[test]
fn names_that_measures_and_motions_use_must_exist() {
    told(
        "body = \"bar\"",
        "body = \"baar\"",
        "unknown-name",
        "\"baar\"",
        "no body called `baar`",
        "did you mean `bar`?",
    );
    told("body = \"bar\"", "region = \"top\"", "unknown-name", "\"top\"", "no region called `top`", "no regions");
    let field = "maximum = { field = \"temprature\" }";
    told(
        "extent = { body = \"bar\", axis = \"y\" }",
        field,
        "unknown-choice",
        "\"temprature\"",
        "unknown field",
        "`temperature`",
    );
    told("axis = \"y\"", "axis = \"z\"", "wrong-dimensions", "\"z\"", "plane strain: there is no z axis", "");
    let component = "mean = { field = \"pressure\", component = \"x\" }";
    told(
        "extent = { body = \"bar\", axis = \"y\" }",
        component,
        "unknown-name",
        "\"x\"",
        "is a scalar",
        "leave `component` out",
    );
    let motion = "[[motion]]\nregion = \"grip\"\nvelocity = [\"free\", 0]\n[[wall]]";
    told("[[wall]]", motion, "unknown-name", "\"grip\"", "no region called `grip`", "");
}

#[test]
fn names_are_given_once() {
    let second = "[[measure]]\nname = \"height\"\nextent = { axis = \"x\" }\n[[wall]]";
    let problem = fault(&changed("[[wall]]", second));
    assert_eq!((problem.code(), problem.labels().len()), ("duplicate-name", 2));
    told("\"anvil\"", "\"an anvil\"", "bad-name", "\"an anvil\"", "cannot name a wall", "letters, digits");
}

#[test]
fn times_of_a_table_increase() {
    let velocity = "name = \"anvil\"\nvelocity = [0, [[\"0 us\", 0], [\"2 us\", 1], [\"1 us\", 2]]]";
    told("name = \"anvil\"", velocity, "time-order", "\"1 us\"", "must increase", "");
    let row = "name = \"anvil\"\nvelocity = [0, [[\"0 us\", 0], [\"2 us\"]]]";
    told("name = \"anvil\"", row, "wrong-length", "[\"2 us\"]", "expected 2 entries", "");
}

#[test]
fn what_is_no_toml_is_marked_where_it_breaks() {
    let problem = fault(&changed("end = \"60 us\"", "end = "));
    assert_eq!((problem.code(), problem.line()), ("toml", Some(11)));
    assert_eq!(fault(&changed("[0, 1]", "[0, 1")).code(), "toml");
}

#[test]
fn missing_keys_say_what_to_write() {
    told("end = \"60 us\"", "", "missing-key", "[time]", "`time` has no `end`", "add end = \"60 us\"");
    told("[time]\nend = \"60 us\"", "", "missing-key", "", "the deck has no `time`", "add time = { end = \"60 us\" }");
    told("plane = {", "# plane = {", "exactly-one", "\"anvil\"", "a wall needs one of `plane` or `segment`", "");
}

#[test]
fn the_deck_has_as_many_components_as_dimensions() {
    told("\"-200 m/s\"]", "\"-200 m/s\", 3]", "wrong-dimensions", "3", "must be zero", "leave it out");
    told("[0, 1]", "[1]", "wrong-dimensions", "[1]", "expected 2 components, found 1", "");
    told("\"plane-strain\"", "\"2d\"", "unknown-choice", "\"2d\"", "`2d`", "did you mean `plane-strain`?");
    let sphere = "shape = { sphere = { centre = [0, \"9 mm\"], radius = \"3 mm\" } }";
    let old = "shape = { box = { min = [\"-3.8 mm\", \"0 mm\"], max = [\"3.8 mm\", \"25.46 mm\"] } }";
    told(old, sphere, "wrong-dimensions", "\"3 mm\"", "there is no sphere", "`disc`");
}

#[test]
fn walls_symmetry_planes_and_cells_leave_room_for_the_bodies() {
    told(
        "[0, 1]",
        "[0, -1]",
        "behind-wall",
        "\"anvil\"",
        "body `bar` is on or behind wall `anvil`",
        "the normal points",
    );
    let plane = "[[symmetry]]\naxis = \"x\"\n[[wall]]";
    told("[[wall]]", plane, "across-symmetry", "\"x\"", "body `bar` reaches across", "end the body at the plane");
    let behind = |more: &str| format!("[[symmetry]]\naxis = \"x\"\n{more}\n[[wall]]");
    let whole = "the whole body is behind the plane: set `side = \"negative\"`";
    told("[[wall]]", &behind("at = \"4 mm\""), "across-symmetry", "\"x\"", "body `bar` reaches across", whole);
    let whole = "set `side = \"positive\"`";
    let sides = behind("at = \"-4 mm\"\nside = \"negative\"");
    told("[[wall]]", &sides, "across-symmetry", "\"x\"", "body `bar` reaches across", whole);
    let cell = "[periodic]\nx = [\"-3 mm\", \"3 mm\"]\n[[wall]]";
    let report = refused(&changed("[[wall]]", cell));
    assert_eq!(report.problems()[0].code(), "outside-cell", "{report}");
    // 25 cells of 0.3 mm in a cell of 7.4 mm: the ends are 0.2 mm apart, which is near but no overlap; in 7.3 mm they are 0.1.
    let fits = "[periodic]\nx = [\"-3.7 mm\", \"3.7 mm\"]\n[[wall]]";
    assert!(load_text("deck", &changed("[[wall]]", fits), &[]).is_ok());
    told("[[wall]]", &fits.replace("3.7", "3.65"), "periodic-overlap", "[\"-3.65 mm\", \"3.65 mm\"]", "two ends", "");
}

#[test]
fn smoothing_lengths_that_change_need_lists_that_are_renewed() {
    let follow = "[numerics]\nsmoothing-length = \"follow-density\"\n[time]";
    let deck = changed("[time]", follow).replace("search = \"every-step\"", "search = \"adaptive\"");
    let problem = fault(&deck);
    assert_eq!((problem.code(), problem.line()), ("wrong-search", Some(11)), "{problem}");
    assert!(load_text("deck", &changed("[time]", follow), &[]).is_ok());
}

#[test]
fn a_contact_needs_a_search_that_sees_other_bodies() {
    let every = "search = \"every-step\"";
    for contact in ["\"penalty\"", "{ penalty = { friction = 0.2 } }"] {
        for (search, message) in [
            ("{ total-lagrangian = { form = \"frozen\" } }", "do not include approaching bodies"),
            ("{ adaptive = { guard = \"none\" } }", "without its guard"),
        ] {
            let with = format!("contact = {contact}\nsearch = {search}");
            told(every, &with, "not-together", contact, message, "choose another `search`");
        }
        for search in ["\"adaptive\"", "\"skin\"", "\"every-step\"", "\"total-lagrangian\""] {
            let with = format!("contact = {contact}\nsearch = {search}");
            assert!(load_text("deck", &changed(every, &with), &[]).is_ok(), "{with}");
        }
    }
}

#[test]
fn a_method_and_a_search_that_is_not_its_own_are_both_shown() {
    let both = "method = \"total-lagrangian\"\nsearch = \"every-step\"";
    told(
        "search = \"every-step\"",
        both,
        "not-together",
        "\"every-step\"",
        "not over those a search finds",
        "leave one of them out",
    );
    let integrator = "numerics = { integrator = \"predictor-corrector\" }\n#";
    let help = "`method = \"updated-lagrangian\"`";
    told(
        "search = \"every-step\"",
        integrator,
        "not-together",
        "\"predictor-corrector\"",
        "integrated by leapfrog",
        help,
    );
}

#[test]
fn bodies_in_total_lagrangian_form_meet_in_a_contact() {
    let total = changed("search = \"every-step\"", "search = \"total-lagrangian\"");
    let second = "[[body]]\nname = \"striker\"\nmaterial = \"armco-iron\"\n\
                  shape = { box = { min = [\"-3.81 mm\", \"30 mm\"], max = [\"3.81 mm\", \"35 mm\"] } }\n[[wall]]";
    let two = total.replace("[[wall]]", second);
    let contact = |deck: &str| load_text("deck", deck, &[]).unwrap_or_else(|r| panic!("{r}")).model.contact;
    assert!(
        matches!(contact(&two), BodyContact::Facets { whole, apart } if (whole.stiffness, apart.stiffness) == (2.0, 1.0))
    );
    let overlap = two.replace("search =", "contact = { penalty = { surfaces = \"overlap\" } }\nsearch =");
    assert!(matches!(contact(&overlap), BodyContact::Penalty(strength) if strength.stiffness == 1.0));
    // One body alone meets itself by overlap.
    assert!(matches!(contact(&total), BodyContact::Penalty(_)));
    assert_eq!(contact(&two.replace("\"total-lagrangian\"", "\"skin\"")), BodyContact::Sph);
    // One body has none to meet.
    let kernel_sum = |deck: &str| deck.replace("search =", "contact = \"kernel-sum\"\nsearch =");
    assert!(load_text("deck", &kernel_sum(&total), &[]).is_ok());
    let problem = fault(&kernel_sum(&two));
    assert_eq!(problem.code(), "not-together", "{problem}");
    assert!(problem.to_string().contains("cannot interact through kernel sums"), "{problem}");
    // The same where the form is that of the default method, or of one that is named.
    for named in ["", "method = \"total-lagrangian\""] {
        let deck = kernel_sum(&two).replace("search = \"total-lagrangian\"", named);
        let problem = fault(&deck);
        assert!(problem.to_string().contains("cannot interact through kernel sums"), "{named}: {problem}");
        let deck = two.replace("search = \"total-lagrangian\"", named);
        let cell = deck.replace("[[wall]]", "[periodic]\nx = [\"-3.9 mm\", \"3.9 mm\"]\n[[wall]]");
        assert!(fault(&cell).to_string().contains("across the ends of a periodic cell"), "{named}");
    }
    let cell = two.replace("[[wall]]", "[periodic]\nx = [\"-3.9 mm\", \"3.9 mm\"]\n[[wall]]");
    let problem = fault(&cell);
    assert!(problem.to_string().contains("across the ends of a periodic cell"), "{problem}");
}

#[test]
fn constants_of_a_search_that_are_not_used_are_refused() {
    let every = "search = \"every-step\"";
    let bound = "search = { adaptive = { guard = \"none\", strain-bound = 0.01 } }";
    told(every, bound, "not-together", "0.01", "does not use a strain bound", "`strain-bound`");
    let hourglass = "search = { total-lagrangian = { form = \"frozen\", hourglass = 3 } }";
    told(every, hourglass, "not-together", "3", "no hourglass control", "`hourglass`");
    let faces = "search = { total-lagrangian = { form = \"frozen\", faces = \"quadratic\" } }";
    told(every, faces, "not-together", "\"quadratic\"", "no correction at faces", "`faces`");
}

#[test]
fn fields_listed_twice_are_refused() {
    let output = "[output]\nfields = [\"velocity\", \"energy\", \"velocity\"]\n[[wall]]";
    let deck = changed("[[wall]]", output);
    let problem = fault(&deck);
    assert_eq!(problem.code(), "duplicate-name", "{problem}");
    assert!(problem.to_string().contains("`velocity` is listed twice"), "{problem}");
    let tracer = "[[tracer]]\nname = \"a\"\npoint = [0, \"1 mm\"]\nfields = [\"energy\", \"energy\"]\n[[wall]]";
    assert_eq!(fault(&changed("[[wall]]", tracer)).code(), "duplicate-name");
}

#[test]
fn tracers_that_follow_need_a_particle_near() {
    let tracer = |point: &str, more: &str| format!("[[tracer]]\nname = \"tail\"\npoint = {point}{more}\n[[wall]]");
    let (near, far) = ("[\"0 mm\", \"25.9 mm\"]", "[\"0 mm\", \"27 mm\"]");
    // The last row of particles is at 25.35 mm, and may be 0.6 mm away.
    assert!(load_text("deck", &changed("[[wall]]", &tracer(near, "")), &[]).is_ok());
    assert!(load_text("deck", &changed("[[wall]]", &tracer(far, "\nfixed = true")), &[]).is_ok());
    told("[[wall]]", &tracer(far, ""), "stray-tracer", far, "starts outside all bodies", "`fixed = true`");
    told("[[wall]]", &tracer(far, "\nbody = \"bar\""), "stray-tracer", far, "outside body `bar`", "");
}

#[test]
fn regions_driven_twice_are_refused() {
    let twice = "[[region]]\nname = \"all\"\nbody = \"bar\"\n\
                 [[region]]\nname = \"low\"\nshape = { box = { min = [\"-9 mm\", 0], max = [\"9 mm\", \"1 mm\"] } }\n\
                 [[motion]]\nregion = \"all\"\nvelocity = [0, \"free\"]\n\
                 [[motion]]\nregion = \"low\"\nvelocity = [0, 0]\n[[wall]]";
    told("[[wall]]", twice, "driven-twice", "\"low\"", "driven along x by two motions", "\"free\"");
}

#[test]
fn independent_faults_are_told_together_in_the_order_of_the_text() {
    let deck = changed("search =", "searching =").replace("end =", "stop =").replace("normal = [0, 1]", "normal = 1");
    let codes = |deck: &str| -> Vec<&'static str> { refused(deck).problems().iter().map(|p| p.code()).collect() };
    assert_eq!(codes(&deck), ["unknown-key", "missing-key", "unknown-key", "wrong-type"]);
    let deck = changed("1.2", "0").replace("60 us", "60 mm").replace("\"bar\", axis", "\"baar\", axis");
    assert_eq!(codes(&deck), ["out-of-range", "wrong-quantity", "unknown-name"]);
}

#[test]
fn a_report_shows_line_label_and_help() {
    let report = refused(&changed("\"-200 m/s\"", "\"-200 mm\""));
    let theme = miette::GraphicalTheme::unicode_nocolor();
    let mut text = String::new();
    let handler = miette::GraphicalReportHandler::new_themed(theme).with_width(100);
    let handler = handler.with_word_separator(textwrap::WordSeparator::AsciiSpace);
    let handler = handler.with_word_splitter(textwrap::WordSplitter::NoHyphenation);
    handler.render_report(&mut text, &report).unwrap();
    for part in [
        "expected a velocity (m/s)",
        "deck.toml:17:28",
        "velocity = [\"0 m/s\", \"-200 mm\"]",
        "help: write a velocity",
    ] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn files_that_cannot_be_read_say_so() {
    let report = load(std::path::Path::new("/no/such/deck.toml"), &[], MAX_PARTICLES).err().unwrap();
    assert!(report.to_string().contains("cannot read `/no/such/deck.toml`"), "{report}");
}

#[test]
fn faults_of_velocity_tables_are_told_at_their_place() {
    let velocity = "velocity = [\"0 m/s\", \"-200 m/s\"]";
    let radial = |rest: &str| format!("radial-velocity = {{ {rest} }}");
    let order = "the coordinates of a radial velocity must increase";
    told(velocity, &radial("rows = [[1, 2], [0.5, 3]]"), "place-order", "0.5", order, "");
    told(velocity, &radial("rows = [[-1, 2]]"), "out-of-range", "-1", "zero or above", "");
    told(velocity, &radial("rows = []"), "empty-table", "\"bar\"", "the radial velocity has no rows", "");
    told(
        velocity,
        &radial("axis = \"x\", rows = [[0, 2]]"),
        "wrong-dimensions",
        "\"x\"",
        "plane strain",
        "leave `axis` out",
    );
    assert!(load_text("deck", &changed(velocity, &radial("axis = \"z\", rows = [[0, 2]]")), &[]).is_ok());
    let profile = "velocity-profile = { along = \"x\", amplitude = [1, 0], rows = [[1, 2], [1, 3]] }";
    told(velocity, profile, "place-order", "1", "the coordinates of a velocity profile must increase", "");
}
