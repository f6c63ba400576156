//! High shear of an Armco iron plate: Patiño et al., test 1.

use super::super::{
    Bounds, Case, Effort, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::Runs,
    variant::refinements,
};

const SPACING: &str = "spacing";
const CHOICES: &str = "choices";

/// Density of the iron at rest, kg/m³.
const DENSITY: f64 = 7890.0;

pub(super) const CASE: Case = Case {
    name: "high-shear",
    title: "High shear of an Armco iron plate at 254 m/s",
    about: "Patiño et al., test 1: the upper half of the plate slides over the lower half. The paper shows fields \
            (Figures 2 to 4) and no numbers: strain and temperature are largest in a smooth band between the halves, \
            and the plate does not tear along it, as it did in older particle codes. The band is the two rows of \
            particles next to the plane, without its free ends. Its strain and temperature grow with the resolution: \
            with thermal softening and no length scale in the material, the width of a shear band is that of the \
            kernel.",
    deck: "high-shear",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::Last("temperature"),
            caption: "Temperature at 80 us (the paper's Figure 2)",
        },
        Picture {
            series: SPACING,
            subject: Subject::Last("plastic_strain"),
            caption: "Plastic strain at 80 us (the paper's Figure 3)",
        },
        Picture {
            series: SPACING,
            subject: Subject::History(&["max_plastic_strain", "band_plastic_strain"]),
            caption: "Plastic strain of the band over time",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    // A band two rows high, whatever the spacing.
    let band = |variant: Variant, spacing: f64| {
        variant
            .set("region.band.shape.box.min.1", &format!("\"-{spacing} mm\""))
            .set("region.band.shape.box.max.1", &format!("\"{spacing} mm\""))
    };
    let spacings: &[f64] = match effort {
        Effort::Quick => &[0.758],
        Effort::Full => &[0.758, 0.379, 0.25267],
    };
    let mut variants: Vec<_> = spacings
        .iter()
        .flat_map(|&s| refinements(SPACING, "", &[&format!("{s} mm")]).into_iter().map(move |v| band(v, s)))
        .collect();
    if effort == Effort::Full {
        let choice = |label: &str, path: &str, value: &str| Variant::of_series(label, CHOICES).set(path, value);
        variants.push(choice("no density filter", "numerics.mls-interval", "1000000"));
        variants.push(choice("no XSPH", "numerics.xsph", "0.0"));
        variants.push(choice("no artificial stress", "numerics.artificial-stress", "false"));
        variants.push(choice("leapfrog", "numerics.integrator", "leapfrog"));
    }
    variants
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING).chain(runs.series(CHOICES)) {
        let measure = |name: &str| run.measure(name);
        let finding = |name: &str, unit, value| Finding::new(name, unit, run.label(), value);
        findings.add(finding("largest plastic strain", Unit::NONE, measure("max_plastic_strain")));
        findings.add(finding("largest temperature", Unit::KELVIN, measure("max_temperature")));
        let uneven =
            measure("max_plastic_strain").zip(measure("band_plastic_strain")).map(|(most, mean)| most / mean - 1.0);
        findings.add(
            finding("largest plastic strain above the mean of the band", Unit::PERCENT, uneven).must(
                Bounds::AtMost(0.1),
                "a smooth band: localisation in single particles would raise only the maximum",
            ),
        );
        findings.add(
            finding("fewest neighbours in the band", Unit::NONE, measure("fewest_band_neighbors"))
                .must(Bounds::AtLeast(14.0), "an intact band: particles of the lattice have 20, those at a crack 12"),
        );
        let loose = measure("least_band_density").map(|density| density / DENSITY);
        findings.add(
            finding("lowest density of the band over that at rest", Unit::PERCENT, loose)
                .must(Bounds::AtLeast(0.98), "no voids; the stress of the band is below 1 GPa, 1 % in density"),
        );
        let drift = run.summary().map(|s| s.largest_momentum_drift);
        findings.add(
            finding("drift of linear momentum", Unit::NONE, drift)
                .must(Bounds::AtMost(1e-6), "conserved exactly, up to rounding of the pair sums in single precision"),
        );
    }
    let study = |name: &str, unit, measure: &str| {
        runs.series(SPACING)
            .fold(Study::trend(name, unit), |study, run| study.point(run.label(), run.spacing, run.measure(measure)))
    };
    findings.study(study("mean plastic strain of the band", Unit::NONE, "band_plastic_strain"));
    findings.study(study("mean temperature of the band", Unit::KELVIN, "band_temperature"));
}
