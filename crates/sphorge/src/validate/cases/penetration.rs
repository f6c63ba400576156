//! Aluminium disc through an aluminium plate: Patiño et al., test 3.

use super::super::{
    Bounds, Case, Effort, ExpectedWarning, Finding, ReferenceKind, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};

const SPACING: &str = "spacing";
const CHOICES: &str = "choices";
const DEFAULT: &str = "default method";
/// The metal without strength, with 0.1 GPa of tension, by two methods.
const FLUID: &str = "fluid, updated Lagrangian";
const FLUID_BY_DEFAULT: &str = "fluid, default method";

/// Shifts of the disc, nm: chance decides which clumps of the cloud hold together, and each of the runs is judged.
const SHIFTS: [u32; 2] = [1, 2];

/// Diameter of the crater in m and length over width of the cloud of three codes (Patiño et al., Table 6).
const PUBLISHED: [(&str, f64, f64); 3] =
    [("Patiño et al.", 0.032, 1.388), ("Liu et al.", 0.0335, 1.33), ("Hiermaier et al.", 0.035, 1.11)];

/// Diameter of the crater in m and length over width of the cloud of the metal as a fluid, on a grid at rest of 0.2 mm
/// (`reference/eulerian/perforation.py`); with 0.4 mm 39.2 mm and 1.252, with 0.1 mm 40.0 mm and 1.330.
const ON_A_GRID: (f64, f64) = (0.0404, 1.234);

pub(super) const CASE: Case = Case {
    name: "penetration",
    title: "Aluminium disc through an aluminium plate at 6180 m/s",
    about: "Patiño et al., test 3, at 20 us. The crater is the clear opening of the plate (all particles connected \
            with it). The cloud is everything that is no longer part of the plate; its length is measured from the \
            back face of the undeformed plate, and the outermost per cent of its mass is left out. The paper does \
            not say how it measures either.",
    deck: "penetration",
    expected_warnings: &[
        ExpectedWarning::new(
            "pieces",
            "perforation breaks the plate and the projectile without a fracture law: the fragments follow from the \
             numerical sums",
        ),
        ExpectedWarning::new(
            "pairing",
            "a tenth of the disc (0.107 at 0.4 mm) is in pairs at 2.7 us, behind the shock where release pulls it \
                     apart, not late in the debris: numerical fracture that the artificial stress does not prevent",
        ),
        ExpectedWarning::new("tearing", "the same failure, in a part of the disc"),
        ExpectedWarning::new(
            "hot",
            "the artificial stress takes up to 2 MJ/kg more than they hold from 0.7 % of the particles; the temperature \
                     does not include this work and is then above what their energy allows",
        ),
        ExpectedWarning::new("lost-neighbors", "the debris contains fragments of one or two particles"),
        ExpectedWarning::new(
            "cold",
            "strongly expanded debris is outside the range of the pressure law, whose isotherm then does not give a \
             meaningful temperature",
        ),
        ExpectedWarning::new("expansion", "the debris is strongly expanded, and the material has no `spall-pressure`"),
    ],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::BeforeAfter("plastic_strain"),
            caption: "Plastic strain before the impact and at 20 us (the paper's Figures 7 and 8)",
        },
        Picture {
            series: SPACING,
            subject: Subject::History(&["crater_diameter", "cloud_length", "cloud_width"]),
            caption: "Crater and cloud over time",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["0.4 mm"],
        Effort::Full => &["0.4 mm", "0.2 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    if effort == Effort::Full {
        let choice = |label: &str, path: &str, value: &str| {
            Variant::of_series(label, CHOICES).spacing("0.4 mm").set(path, value)
        };
        variants.push(choice("0.4 mm, viscosity 1, 2", "numerics.viscosity", "{ alpha = 1.0, beta = 2.0 }"));
        variants.push(choice("0.4 mm, no XSPH", "numerics.xsph", "0.0"));
        variants.push(choice("0.4 mm, no artificial stress", "numerics.artificial-stress", "false"));
        variants.push(choice("0.4 mm, leapfrog", "numerics.integrator", "leapfrog"));
        variants.push(choice("0.4 mm, temperature from plastic work", "numerics.temperature", "plastic-work"));
        variants.push(by_default("0.4 mm"));
        variants.push(by_default("0.2 mm"));
        variants.extend(SHIFTS.map(|shift| {
            let centre = format!("[\"0 mm\", \"5.00000{shift} mm\"]");
            let mut shifted = by_default("0.2 mm").set("body.disc.shape.disc.centre", &centre);
            shifted.label = format!("0.2 mm, {DEFAULT}, shifted by {shift} nm");
            shifted
        }));
        // Of no tension at all the run breaks down where debris expands ten thousandfold.
        for (label, method, search) in
            [(FLUID, "updated-lagrangian", "skin"), (FLUID_BY_DEFAULT, "total-lagrangian", "total-lagrangian")]
        {
            let mut fluid = by_default("0.2 mm")
                .set("method", method)
                .set("search", search)
                .set("material.aluminium-patino.strength", "none")
                .set("material.aluminium-patino.spall-pressure", "\"100 MPa\"");
            fluid.label = format!("0.2 mm, {label}");
            variants.push(fluid);
        }
    }
    variants
}

/// Geometry, material and load of the deck with the default method.
fn by_default(spacing: &str) -> Variant {
    let variant = Variant::of_series(format!("{spacing}, {DEFAULT}"), CHOICES).spacing(spacing);
    let choices = [
        ("method", "total-lagrangian"),
        ("search", "total-lagrangian"),
        ("numerics.viscosity", "true"),
        ("numerics.temperature", "plastic-work"),
    ];
    choices.into_iter().fold(variant, |variant, (path, value)| variant.set(path, value))
}

/// Length over width of the cloud.
fn slenderness(run: &Run) -> Option<f64> {
    run.measure("cloud_length").zip(run.measure("cloud_width")).map(|(length, width)| length / width)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING).chain(runs.series(CHOICES)) {
        let is_fluid_by_default = run.label().ends_with(FLUID_BY_DEFAULT);
        let is_fluid = is_fluid_by_default || run.label().ends_with(FLUID);
        // The default method holds a fluid together until it is stretched fourfold.
        let known = |within: f64| is_fluid_by_default.then_some(Bounds::Relative(within));
        let at_the_papers = run.label().starts_with("0.2 mm") && !is_fluid;
        let beside = |finding: Finding, of: fn(&(&str, f64, f64)) -> f64| {
            PUBLISHED.iter().fold(finding, |f, row| f.beside(ReferenceKind::Published, row.0, of(row)))
        };
        let crater = Finding::new("crater diameter", Unit::CENTIMETRE, run.label(), run.measure("crater_diameter"))
            .beside(ReferenceKind::Experiment, "experiment, least", 0.0275)
            .beside(ReferenceKind::Experiment, "experiment, most", 0.0345);
        let on_a_grid = |finding: Finding, value: f64| {
            if is_fluid { finding.beside(ReferenceKind::Eulerian, "a fluid on a fixed grid", value) } else { finding }
        };
        findings.add(if at_the_papers {
            crater.must(Bounds::InRange, "within the range of the experiments")
        } else if is_fluid {
            let crater = Finding::new("crater diameter", Unit::CENTIMETRE, run.label(), run.measure("crater_diameter"));
            on_a_grid(crater, ON_A_GRID.0)
                .must(Bounds::Relative(0.07), "effect of the remaining tension: see below")
                .missed_within(known(0.11))
        } else {
            beside(crater, |row| row.1)
        });
        let cloud = Finding::new("length over width of the cloud", Unit::NONE, run.label(), slenderness(run));
        let cloud = on_a_grid(cloud, ON_A_GRID.1);
        findings.add(match run.label() {
            _ if is_fluid => cloud
                .must(Bounds::Relative(0.05), "at equal spacing; the grid gives 1.25 with 0.4 mm, 1.33 with 0.1 mm")
                .missed_within(known(0.09)),
            label => {
                let cloud = beside(cloud.beside(ReferenceKind::Experiment, "experiment", 1.39), |row| row.2);
                match label {
                    "0.2 mm" => cloud.must(
                        Bounds::Relative(0.137),
                        "1.2 to 1.58: the experiment, with the uncertainty of the measuring rule",
                    ),
                    _ if at_the_papers => cloud.must(Bounds::InRange, "within the range of the published values"),
                    _ => cloud,
                }
            }
        });
        let finding = |name: &str, value| Finding::new(name, Unit::NONE, run.label(), value);
        let rounding = "rounding of pair sums in single precision over some thousand steps";
        let energy = run.summary().map(|s| s.energy.largest_relative_drift);
        findings.add(finding("drift of the energy balance", energy).must(Bounds::AtMost(1e-6), rounding));
        let momentum = run.summary().map(|s| s.largest_momentum_drift);
        findings.add(finding("drift of linear momentum", momentum).must(Bounds::AtMost(1e-6), rounding));
    }
    let trend = |name: &str, unit, of: &dyn Fn(&Run) -> Option<f64>| {
        runs.series(SPACING).fold(Study::trend(name, unit), |study, run| study.point(run.label(), run.spacing, of(run)))
    };
    findings.study(trend("crater diameter", Unit::CENTIMETRE, &|run| run.measure("crater_diameter")));
    findings.study(trend("length over width of the cloud", Unit::NONE, &slenderness));
    findings.note(
        "The metal as a fluid without tension has a cloud of 1.25, 1.23, 1.33 on fixed grids of 0.4, 0.2, 0.1 mm \
         (`reference/eulerian`), whose program gives the exact pressure of a plate impact at this speed. As a fluid \
         with a tension of up to 0.1 GPa the updated Lagrangian form, which is advised for fluids that splash, gives \
         1.25 with 0.2 mm and a crater that is 3 % narrower. The default method holds a fluid together until it is \
         stretched fourfold: its crater is 10 % narrower and its cloud has 1.12, and a note names the other form to whoever \
         runs it. With the disc where it is, and shifted by 1 nm, the default method has clouds of 1.209 and 1.202, as \
         chance decides which clumps hold together. The method \
         of the paper gives the result of the paper: at 0.4 mm 1.53, of which 0.13 are due to its artificial stress \
         and 0.04 to XSPH. The other reasons for its slender cloud were not traced.",
    );
    findings.note(
        "Temperatures of single particles in the cloud are not reliable: the material has no tensile strength of its \
         own in this case, and a fragment stretched far below its density at rest has a cold energy that no metal \
         has.",
    );
}
