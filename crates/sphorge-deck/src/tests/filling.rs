//! Bodies filled with particles, as decks ask for it.

use crate::load_text;
use sphorge_engine::Particles;
use sphorge_engine::model::Arrangement;

fn deck(dimensions: &str, rest: &str) -> Particles {
    let text = format!(
        "dimensions = \"{dimensions}\"\n[particles]\nspacing = 0.5\n[time]\nend = 1\n\
         [material.m]\ndensity = 1000\nyoung-modulus = 1e9\npoisson-ratio = 0.3\nstrength = \"elastic\"\n{rest}"
    );
    match load_text("deck", &text, &[]) {
        Ok(setup) => setup.particles,
        Err(report) => panic!("{:?}", report.problems()),
    }
}

const BOX: &str = "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0], max = [1, 1] } }\n";

#[test]
fn particles_move_and_turn_as_their_body() {
    let particles = deck("plane-strain", &format!("{BOX}velocity = [3, 0]\nspin = {{ rate = 2, centre = [1, 0] }}\n"));
    assert_eq!(particles.position[1], [0.75, 0.25, 0.0]);
    // v + w x r with w = 2 about z and r = (-0.25, 0.25).
    assert_eq!(particles.velocity[1], [3.0 - 0.5, -0.5, 0.0]);
    assert_eq!((particles.id[3], particles.mass[3], particles.density[3]), (3, 250.0, 1000.0));
    assert_eq!((particles.smoothing_length[0], particles.temperature[0]), (0.55, 293.15));
    // c0 = sqrt(K/rho), K = E/(3 (1 - 2 nu)).
    assert!((particles.sound_speed[0] - (1e9f64 / 1.2 / 1000.0).sqrt()).abs() < 1e-9);
}

#[test]
fn spin_in_space_is_about_its_vector() {
    let body = "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
    let particles = deck("3d", &format!("{body}spin = {{ rate = [0, 4, 0] }}\n"));
    // w = (0, 4, 0), r = (0.25, 0.25, 0.25): w x r = (1, 0, -1).
    assert_eq!(particles.velocity[0], [1.0, 0.0, -1.0]);
    assert_eq!((particles.len(), particles.mass[0]), (8, 125.0));
}

#[test]
fn initial_velocities_vary_in_space_as_asked() {
    let particles = deck(
        "plane-strain",
        &format!(
            "{BOX}velocity = [3, 0]\nvelocity-gradient = {{ rows = [[1, 10], [100, 1000]], centre = [0, 0.75] }}\n\
             velocity-profile = {{ along = \"x\", amplitude = [0, 8], rows = [[0.5, 0], [1, 1]] }}\n"
        ),
    );
    // At (0.75, 0.25), (0.75, -0.5) from the centre, half of the amplitude.
    assert_eq!(particles.position[1], [0.75, 0.25, 0.0]);
    assert_eq!(particles.velocity[1], [3.0 + 0.75 - 5.0, 75.0 - 500.0 + 4.0, 0.0]);
    // At (0.25, 0.25) the profile is what it is at its first row.
    assert_eq!(particles.velocity[0], [3.0 + 0.25 - 5.0, 25.0 - 500.0, 0.0]);
}

#[test]
fn radial_velocities_go_outwards_from_a_centre_or_a_line() {
    // From (1, 0): at (0.25, 0.25) r = 0.79057, at (0.75, 0.25) r = 0.35355; 4 m/s at 0.25 m, 12 m/s at 0.75 m and beyond.
    let radial = "radial-velocity = { centre = [1, 0], rows = [[0.25, 4], [0.75, 12]] }\n";
    let particles = deck("plane-strain", &format!("{BOX}velocity = [100, 0]\n{radial}"));
    let near = |found: [f64; 3], expected: [f64; 3]| {
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{found:?} is not {expected:?}");
    };
    let (r0, r1) = (0.625f64.sqrt(), 0.125f64.sqrt());
    near(particles.velocity[0], [100.0 - 12.0 * 0.75 / r0, 12.0 * 0.25 / r0, 0.0]);
    let v1 = 4.0 + 8.0 * (r1 - 0.25) / 0.5;
    near(particles.velocity[1], [100.0 - v1 * 0.25 / r1, v1 * 0.25 / r1, 0.0]);
    // In space from a line along y: nothing along it.
    let body = "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
    let line = "radial-velocity = { axis = \"y\", rows = [[0, 0], [2, 16]] }\n";
    near(deck("3d", &format!("{body}{line}")).velocity[7], [6.0, 0.0, 6.0]);
    let point = "radial-velocity = { rows = [[0, 0], [2, 16]] }\n";
    near(deck("3d", &format!("{body}{point}")).velocity[7], [6.0, 6.0, 6.0]);
    // A particle in the centre stays.
    let centre = "placement = \"on-faces\"\nradial-velocity = { rows = [[0, 5]] }\n";
    assert_eq!(deck("plane-strain", &format!("{BOX}{centre}")).velocity[0], [0.0; 3]);
}

#[test]
fn regions_are_bits_of_what_body_and_shape_choose() {
    let regions = "[[region]]\nname = \"left\"\nshape = { box = { min = [0, 0], max = [0.25, 1] } }\n\
                   [[region]]\nname = \"second\"\nbody = \"c\"\n\
                   [[region]]\nname = \"low\"\nbody = \"b\"\nshape = { box = { min = [0, 0], max = [1, 0.5] } }\n";
    let other = BOX.replace("\"b\"", "\"c\"").replace("[0, 0]", "[1, 0]").replace("[1, 1]", "[2, 1]");
    let particles = deck("plane-strain", &format!("{BOX}{other}{regions}"));
    // Particles on the surface of a region belong to it.
    assert_eq!(particles.regions, [0b101, 0b100, 0b001, 0, 0b010, 0b010, 0b010, 0b010]);
    assert_eq!(particles.body, [0, 0, 0, 0, 1, 1, 1, 1]);
}

#[test]
fn a_turned_box_has_a_turned_lattice() {
    let turned =
        BOX.replace("[1, 1] } }", "[1, 1] }, rotate = { angle = \"90 deg\", about = [1, 0] }, shift = [0, 2] }");
    let particles = deck("plane-strain", &turned);
    // (0.25, 0.25) turns about (1, 0) to (0.75, -0.75) and is shifted by 2.
    assert!((particles.position[0][0] - 0.75).abs() < 1e-15 && (particles.position[0][1] - 1.25).abs() < 1e-15);
}

#[test]
fn bodies_of_unlike_spacing_touch_and_overlap() {
    let fine = |min: &str| {
        format!(
            "{BOX}[[body]]\nname = \"fine\"\nmaterial = \"m\"\nspacing = 0.1\n\
             shape = {{ box = {{ min = [{min}, 0], max = [2, 1] }} }}\n"
        )
    };
    assert_eq!(deck("plane-strain", &fine("1")).len(), 4 + 100);
    let text = format!(
        "dimensions = \"plane-strain\"\n[particles]\nspacing = 0.5\n[time]\nend = 1\n\
         [material.m]\nbase = \"armco-iron\"\n{}",
        fine("0.7")
    );
    let Err(report) = load_text("deck", &text, &[]) else { panic!("they overlap") };
    assert_eq!(report.problems()[0].to_string(), "bodies `b` and `fine` overlap");
}

fn notes(text: &str) -> Vec<String> {
    let setup = load_text("deck", text, &[]).unwrap_or_else(|report| panic!("{:?}", report.problems()));
    setup.notes
}

/// A copper bar of 7.62 mm x 25.4 mm that ends in a symmetry plane.
fn copper_bar(particles: &str) -> String {
    format!(
        "dimensions = \"3d\"\nsymmetry = [{{ axis = \"z\" }}]\ntime = {{ end = \"1 us\" }}\nparticles = {{ {particles} }}\n\
         [[body]]\nname = \"bar\"\nmaterial = \"ofhc-copper\"\nvelocity = [0, 0, -1]\n\
         [body.shape.cylinder]\nfrom = [\"0 mm\", \"0 mm\", \"0 mm\"]\nto = [\"0 mm\", \"0 mm\", \"25.4 mm\"]\nradius = \"3.81 mm\"\n"
    )
}

/// The spacings a note proposes.
fn proposed(note: &str) -> Vec<&str> {
    let (_, listed) = note.rsplit_once("fit better: ").expect(note);
    listed.split(", ").take_while(|part| !part.starts_with("or ")).collect()
}

#[test]
fn a_lattice_that_does_not_end_at_a_symmetry_plane_is_told_with_spacings_that_do() {
    // 40 layers of 0.63 mm in 25.4 mm: (25.4 - 39 0.63)/2 = 0.415. 0.8 % is missing in the length, the section has 120 squares
    // where its circle has 114.9.
    let told = notes(&copper_bar("spacing = \"0.63 mm\", lattice = \"square\""));
    assert_eq!(told.len(), 1, "{told:?}");
    let expected = "line 6: body `bar`: its particles have 3.6 % more mass than its shape, its first layer of particles is 0.4150 mm from the symmetry plane across z instead of half a spacing (0.3150 mm); ";
    assert!(told[0].starts_with(expected), "{told:?}");
    let proposed = proposed(&told[0]);
    assert_eq!(proposed.len(), 2, "{told:?}");
    for spacing in proposed {
        let told = notes(&copper_bar(&format!("spacing = \"{spacing}\", lattice = \"square\"")));
        assert_eq!(told, Vec::<String>::new(), "at {spacing}");
    }
    // 40 layers of 0.635 mm end at the plane, and so do rings.
    assert_eq!(notes(&copper_bar("spacing = \"0.635 mm\", lattice = \"square\"")), Vec::<String>::new());
    assert_eq!(notes(&copper_bar("spacing = \"0.63 mm\", lattice = \"rings\"")), Vec::<String>::new());
}

#[test]
fn a_round_body_gets_rings_from_the_total_lagrangian_form_alone_and_where_the_deck_says_nothing_else() {
    let arrangement = |top: &str, particles: &str| {
        let bar = copper_bar(&format!("spacing = \"0.635 mm\"{particles}"));
        let text = format!("{top}{}", bar.replace("symmetry = [{ axis = \"z\" }]\n", ""));
        let setup = load_text("deck", &text, &[]).unwrap_or_else(|report| panic!("{:?}", report.problems()));
        setup.model.bodies[0].lattice.arrangement
    };
    assert_eq!(arrangement("", ""), Arrangement::Rings);
    assert_eq!(arrangement("method = \"updated-lagrangian\"\n", ""), Arrangement::Square);
    assert_eq!(arrangement("method = \"fraser\"\nsearch = \"total-lagrangian\"\n", ""), Arrangement::Rings);
    assert_eq!(arrangement("", ", lattice = \"hexagonal\""), Arrangement::Hexagonal);
    assert_eq!(arrangement("", ", placement = \"on-faces\""), Arrangement::Square);
    let boxed = load_text(
        "deck",
        "dimensions = \"3d\"\ntime = { end = 1 }\nparticles = { spacing = 0.5 }\n\
        [[body]]\nname = \"b\"\nmaterial = \"ofhc-copper\"\nshape = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n",
        &[],
    );
    assert_eq!(boxed.map_err(|_| ()).unwrap().model.bodies[0].lattice.arrangement, Arrangement::Square);
}

#[test]
fn rings_are_halved_and_quartered_by_symmetry_planes() {
    let tube = |planes: &str, low: &str| {
        format!(
            "dimensions = \"3d\"\nsymmetry = [{planes}]\ntime = {{ end = 1, max-steps = 1 }}\n\
             particles = {{ spacing = \"0.05 m\", lattice = \"rings\" }}\n[[body]]\nname = \"tube\"\nmaterial = \"ofhc-copper\"\nvelocity = [0, 0, 1]\n\
             [[body.shape.intersection]]\n\
             cylinder = {{ from = [0, 0, 0], to = [0, 0, 0.2], radius = 0.52, inner-radius = 0.27 }}\n\
             [[body.shape.intersection]]\nbox = {{ min = {low}, max = [1, 1, 1] }}\n"
        )
    };
    let mass = |deck: &str| {
        let setup = load_text("deck", deck, &[]).unwrap_or_else(|report| panic!("{:?}", report.problems()));
        assert_eq!(setup.notes, Vec::<String>::new());
        setup.masses[0].mass
    };
    let whole = mass(&tube("", "[-1, -1, -1]"));
    let (x, y) = ("{ axis = \"x\" }", "{ axis = \"y\" }");
    for (planes, low, parts) in [
        (y.to_owned(), "[-1, 0, -1]", 2.0),
        (x.to_owned(), "[0, -1, -1]", 2.0),
        (format!("{x}, {y}"), "[0, 0, -1]", 4.0),
    ] {
        assert!((mass(&tube(&planes, low)) * parts / whole - 1.0).abs() < 1e-12, "{planes}");
    }
}

#[test]
fn a_lattice_that_weighs_more_or_less_than_its_shape_is_told() {
    // Three cells of 0.3 along either edge of a square of 1: 0.81 of its area.
    let square = |rest: &str| {
        let head =
            "dimensions = \"plane-strain\"\ntime = { end = 1, max-steps = 1 }\nparticles = { spacing = \"0.3 m\" }\n";
        format!("{head}{}velocity = [1, 0]\n{rest}", BOX.replace("\"m\"", "\"ofhc-copper\""))
    };
    let told = notes(&square(""));
    let spacings = "spacings that fit better: 250 mm, 333.33 mm";
    assert_eq!(told, [format!("line 5: body `b`: its particles have 19.0 % less mass than its shape; {spacings}")]);
    let setup = load_text("deck", &square(""), &[]).unwrap();
    let mass = setup.masses[0];
    assert!(mass.particles == 9 && !mass.is_estimate);
    assert!((mass.mass / (8960.0 * 0.81) - 1.0).abs() < 1e-12 && (mass.shape_mass - 8960.0).abs() < 1e-9);
    // Masses are those of the cells: the density of the start is the reference density in the space that is filled.
    assert!(setup.particles.mass.iter().all(|m| (m / (8960.0 * 0.09) - 1.0).abs() < 1e-12));
    let told = notes(&square("spacing = \"0.5 m\"\nplacement = \"on-faces\"\n"));
    assert_eq!(
        told,
        ["line 5: body `b`: its particles have 125.0 % more mass than its shape; `placement = \"cell-centres\"`"]
    );
    assert_eq!(notes(&square("spacing = \"0.5 m\"\n")), Vec::<String>::new());
}

#[test]
fn a_layer_is_told_of_where_the_body_has_a_face_in_a_wall() {
    let square = |spacing: &str, height: &str| {
        format!(
            "dimensions = \"plane-strain\"\ntime = {{ end = 1 }}\nparticles = {{ spacing = {spacing} }}\n\
             [[wall]]\nname = \"floor\"\nplane = {{ point = [0, {height}], normal = [0, 1] }}\n{}velocity = [1, 0]\n",
            BOX.replace("\"m\"", "\"ofhc-copper\"")
        )
    };
    // 35 cells of 0.0285 are 0.9975: (1 - 34 0.0285)/2 = 0.0155, 0.044 spacings too far; of 0.0284: 0.0172, 0.106.
    assert_eq!(notes(&square("0.0285", "0")), Vec::<String>::new());
    let told = notes(&square("0.0284", "0"));
    let expected =
        "its first layer of particles is 17.2000 mm from wall `floor` instead of half a spacing (14.2000 mm)";
    assert!(told[0].contains(expected), "{told:?}");
    // A wall that the body has not reached is at none of its faces.
    let told = notes(&square("0.0284", "-0.001"));
    assert!(!told.iter().any(|note| note.contains("layer")), "{told:?}");
}

#[test]
fn cells_are_where_their_particles_are_and_as_large_as_their_share() {
    let volume = |corners: &[[f64; 3]; 8]| {
        // Of a cell with plane faces: the mean edges span it, exactly for bricks and for sectors with straight edges.
        let mean = |axis: usize, side: usize| -> [f64; 3] {
            let of = (0..8).filter(|k| k >> axis & 1 == side);
            of.fold([0.0; 3], |sum, k| std::array::from_fn(|a| sum[a] + 0.25 * corners[k][a]))
        };
        let edge = |axis: usize| -> [f64; 3] { std::array::from_fn(|a| mean(axis, 1)[a] - mean(axis, 0)[a]) };
        let [u, v, w] = [edge(0), edge(1), edge(2)];
        (0..3).map(|k| u[k] * (v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3])).sum::<f64>()
    };
    let cells = |shape: &str, lattice: &str| {
        let deck = format!(
            "dimensions = \"3d\"\ntime = {{ end = 1 }}\nparticles = {{ spacing = 0.1, lattice = \"{lattice}\" }}\n[[body]]\nname = \"b\"\n\
             material = \"ofhc-copper\"\nvelocity = [1, 0, 0]\nshape = {{ {shape} }}\n"
        );
        let setup = load_text("deck", &deck, &[]).unwrap_or_else(|report| panic!("{:?}", report.problems()));
        let cells = sphorge_engine::geometry::cell_corners(&setup.model);
        assert_eq!(cells.len(), setup.particles.len());
        (cells, setup.particles)
    };
    let turned = "box = { min = [0, 0, 0], max = [0.5, 0.3, 0.2] }, rotate = { axis = [0, 0, 1], angle = \"30 deg\" }";
    let (of_box, particles) = cells(turned, "square");
    for (cell, mass) in of_box.iter().zip(&particles.mass) {
        assert!((volume(cell) * 8960.0 / mass - 1.0).abs() < 1e-9);
    }
    // Along the turned axis: from (-1, -1, -1)/2 to (1, -1, -1)/2 of the spacing.
    let along: [f64; 3] = std::array::from_fn(|k| of_box[0][1][k] - of_box[0][0][k]);
    assert!((along[0] - 0.1 * 0.75f64.sqrt()).abs() < 1e-12 && (along[1] - 0.05).abs() < 1e-12, "{along:?}");
    // Rings meet: the outer corners of a cell are on the surface, and cells lack what their arcs bulge.
    let (of_rings, particles) = cells("cylinder = { from = [0, 0, 0], to = [0, 0, 0.2], radius = 0.5 }", "rings");
    let reach = |cell: &[[f64; 3]; 8], x: &[f64; 3]| {
        (0..8).map(|k| (cell[k][0] + x[0]).hypot(cell[k][1] + x[1])).fold(0.0, f64::max)
    };
    let farthest = of_rings.iter().zip(&particles.position).map(|(cell, x)| reach(cell, x)).fold(0.0, f64::max);
    assert!((farthest - 0.5).abs() < 1e-12, "{farthest}");
    let (cells, masses): (f64, f64) = (of_rings.iter().map(volume).sum(), particles.mass.iter().sum());
    assert!((0.9..1.0).contains(&(cells * 8960.0 / masses)), "{}", cells * 8960.0 / masses);
}

#[test]
fn a_part_of_a_solid_without_its_unit_is_filled_at_once() {
    let bar = |radius: &str, lattice: &str| {
        let deck = format!(
            "dimensions = \"3d\"\nparticles = {{ spacing = \"1.6 mm\", lattice = \"{lattice}\" }}\ntime = {{ end = \"4 us\" }}\n[[body]]\nname = \
             \"bar\"\nmaterial = \"armco-iron\"\nvelocity = [0, 0, 1]\nshape = {{ intersection = [{{ cylinder = {{ from = [0, 0, 0], to = [0, 0, \"32 \
             mm\"], radius = {radius} }} }}, {{ box = {{ min = [0, 0, 0], max = [\"5 mm\", \"5 mm\", \"32 mm\"] }} }}] }}\n"
        );
        load_text("bar", &deck, &[]).unwrap().particles.len()
    };
    for lattice in ["rings", "square", "hexagonal"] {
        // 5 by 5 by 32 mm, but for what the lattice does not fit.
        let (all, within) = (bar("4", lattice), bar("\"10 mm\"", lattice));
        assert!((150..300).contains(&all) && all.abs_diff(within) <= 40, "{lattice}: {all} {within}");
    }
}
