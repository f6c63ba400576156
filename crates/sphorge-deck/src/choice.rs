//! Words a deck chooses from.

use super::defaults;
use super::method::{Method, WallContactKind};
use super::strategy::Strategy;
use super::value::Choices;
use sphorge_engine::model::{
    Arrangement, CraterEdge, Dimensions, FaceGradients, FragmentQuantity, GradientCorrection, Integrator,
    LatticePlacement, Precision, Search, TemperatureSource, WarningKind,
};
use sphorge_engine::particles::{FIELDS, FieldInfo};
use sphorge_physics::{
    damage::AfterFailure,
    kernel::Kernel,
    pair::{EnergySplit, PairForm},
    return_mapping::ReturnRule,
};

macro_rules! words {
    ($( $name:ident, $what:literal, $value:ty { $( $word:literal => $chosen:expr, $meaning:literal; )+ } )+) => { $(
        pub(crate) enum $name {}
        impl Choices for $name {
            type Value = $value;
            const NAME: &'static str = stringify!($name);
            const WHAT: &'static str = $what;
            fn table() -> Vec<(&'static str, $value, &'static str)> {
                vec![ $( ($word, $chosen, $meaning), )+ ]
            }
        }
    )+ };
}

words! {
    ArrangementWord, "lattice", Arrangement {
        "square" => Arrangement::Square, "square in the plane, cubic in space";
        "hexagonal" => Arrangement::Hexagonal, "triangular in the plane, hexagonal close-packed in space";
        "rings" => Arrangement::Rings, "concentric rings of equally spaced particles; for discs and cylinders";
    }
    PlacementWord, "lattice placement", LatticePlacement {
        "cell-centres" => LatticePlacement::CellCentres, "the outermost particles are half a spacing inside the faces";
        "on-faces" => LatticePlacement::OnFaces, "the outermost particles lie on the faces";
    }
    IntegratorWord, "time integrator", Integrator {
        "leapfrog" => Integrator::Leapfrog, "kick, drift, kick";
        "predictor-corrector" => Integrator::PredictorCorrector, "Monaghan (1989)";
    }
    PrecisionWord, "precision", Precision {
        "mixed" => Precision::Mixed, "pair arithmetic in single precision, sums in double";
        "double" => Precision::Double, "everything in double precision";
    }
    GradientCorrectionWord, "gradient correction", GradientCorrection {
        "none" => GradientCorrection::None, "plain kernel gradient";
        "linear" => GradientCorrection::Linear, "exact for linear fields, in the velocity gradient and adjoint in the force";
    }
    PairFormWord, "pair form", PairForm {
        "volume-weighted" => PairForm::VolumeWeighted, "m/rho of the neighbour, (sigma_i + sigma_j)/(rho_i rho_j)";
        "density-weighted" => PairForm::DensityWeighted, "m_j/rho_i, sigma_i/rho_i^2 + sigma_j/rho_j^2";
        "mixed" => PairForm::Mixed, "m/rho of the neighbour, sigma_i/rho_i^2 + sigma_j/rho_j^2 (Patiño et al.): not adjoint";
    }
    EnergySplitWord, "energy split", EnergySplit {
        "own-stress" => EnergySplit::OwnStress, "each particle takes the work of its own stress";
        "symmetric" => EnergySplit::Symmetric, "each takes half (Patiño et al. Eq 10)";
    }
    TemperatureWord, "source of temperature", TemperatureSource {
        "plastic-work" => TemperatureSource::PlasticWork, "heat of plastic work, without that of shocks: the check `missing-heat` warns";
        "energy" => TemperatureSource::Energy, "internal energy minus cold, elastic and stored energy and the work of the artificial stress: for shock heating";
    }
    ReturnRuleWord, "return rule", ReturnRule {
        "radial-return" => ReturnRule::RadialReturn, "factor yield stress over equivalent stress";
        "benz-asphaug" => ReturnRule::BenzAsphaug, "the square of that factor (Patiño et al. Eq 28 as printed)";
    }
    AfterFailureWord, "behaviour after failure", AfterFailure {
        "no-tension" => AfterFailure::NoTension, "bears pressure, no tension and no shear";
        "fluid" => AfterFailure::Fluid, "bears pressure, tension up to `spall-pressure`, and no shear";
        "delete" => AfterFailure::Delete, "bears nothing, and keeps its mass and its velocity";
    }
    SmoothingLengthWord, "smoothing length rule", bool {
        "constant" => false, "as at the start";
        "follow-density" => true, "grows where material expands and shrinks where it is compressed, at most by a factor of 2";
    }
    CompressionWord, "compression of frames", bool {
        "zlib" => true, "zlib, which every reader of VTK files supports";
        "none" => false, "uncompressed: longer files, for programs without zlib";
    }
    PiecesWord, "files of a frame", bool {
        "each-rank" => true, "each rank writes its particles; a `.pvtp` file, which ParaView opens, lists the files";
        "one" => false, "the first rank gathers all particles and writes one file, as a single process does";
    }
    SearchWord, "search strategy", Strategy {
        "every-step" => Strategy::updated(Search::EveryStep), "all particles, every step";
        "skin" => Strategy::updated(defaults::SKIN), "lists with a skin, rebuilt when two particles may have approached each other by its thickness";
        "adaptive" => Strategy::updated(Search::Adaptive(defaults::ADAPTIVE)), "particles whose plastic strain grows (Fraser) and those added by the guard";
        "total-lagrangian" => Strategy::TOTAL, "none after the start: sums over the initial neighbours, until a body comes apart";
    }
    GuardWord, "guard of the adaptive search", Option<f64> {
        "full" => Some(defaults::GUARD_STRAIN), "strained elastic material and contact candidates are searched too, and gradients are taken at the current positions";
        "none" => None, "the rule of Fraser as published, kernel values of the last search";
    }
    FormulationWord, "total Lagrangian form", bool {
        "corrected" => true, "deformation gradient and first Piola-Kirchhoff stress with corrected gradients";
        "frozen" => false, "initial lists and kernel values in the sums of the other strategies (Fraser, Table 1)";
    }
    FaceGradientsWord, "gradients at faces", FaceGradients {
        "linear" => FaceGradients::Linear, "exact for linear fields";
        "quadratic" => FaceGradients::Quadratic, "exact for quadratic fields, as inside a body: metal that yields in bending sees no false change of volume at its faces; not on several cards";
    }
    MethodWord, "method", Method {
        "total-lagrangian" => Method::TotalLagrangian, "sums over the initial neighbours, without numerical fracture up to a stretch of 16, or 4 where a body is liquid; penalty contact of bodies with walls, each other and themselves; leapfrog";
        "updated-lagrangian" => Method::UpdatedLagrangian, "sums over the current neighbours, lists with a skin; bodies interact through kernel sums, walls repel by Monaghan & Kos; leapfrog. For debris that collides again";
        "patino" => Method::Patino, "that of Patiño et al.: the current neighbours, searched every step; artificial stress 0.3 with exponent 4, XSPH 0.5, predictor-corrector";
        "fraser" => Method::Fraser, "that of Fraser et al.: the current neighbours, adaptive search with its guard; artificial stress 0.3 with exponent 6, XSPH 0.5, leapfrog";
    }
    ContactWord, "wall contact", WallContactKind {
        "monaghan-kos" => WallContactKind::MonaghanKos, "repulsion of Monaghan & Kos (1999)";
        "penalty" => WallContactKind::Penalty, "linear penalty with damping and friction; it never pulls";
    }
    BodyContactWord, "contact between bodies", bool {
        "kernel-sum" => false, "particles of other bodies are neighbours like any others, as in the papers: bodies stick, and are compressed before they touch while a gap closes (aluminium plates at 2 km/s: 1.2 times the Hugoniot pressure from face to face, 1.7 times from a gap of a spacing on; with `penalty` 1.07 times from any gap)";
        "penalty" => true, "bodies push each other but never pull; damping and friction";
    }
    ContactSurfacesWord, "surfaces of a contact", bool {
        "facets" => true, "the exposed faces of the cells of the particles, on the surfaces of the shapes: what touches presses nothing, whatever its lattices; only in the total Lagrangian form";
        "overlap" => false, "the kernel-weighted overlap of the particles, which presses with up to 0.3 % of the bulk modulus where lattices in line touch";
    }
    WallSurfacesWord, "where a wall pushes", bool {
        "facets" => true, "the exposed faces of the cells of the particles, on the surfaces of the shapes: round surfaces are round, the ends of segments push between particles, and friction has a tangential spring, so that what sticks does not creep; only in the total Lagrangian form and on processors";
        "particles" => false, "the point of each particle that is nearest to the wall";
    }
    AxisWord, "axis", usize {
        "x" => 0, "first axis";
        "y" => 1, "second axis";
        "z" => 2, "third axis";
    }
    EdgeWord, "edge of a crater", CraterEdge {
        "clear" => CraterEdge::Clear, "the clear opening";
        "entry-lips" => CraterEdge::EntryLips, "from crest to crest of the lips on the entry side";
        "exit-lips" => CraterEdge::ExitLips, "from crest to crest of the lips on the exit side";
    }
    FragmentWord, "quantity of fragments", FragmentQuantity {
        "number" => FragmentQuantity::Number, "how many there are";
        "largest" => FragmentQuantity::Largest, "mass of the heaviest";
        "second" => FragmentQuantity::Second, "mass of the second heaviest, such as a plug";
        "loose" => FragmentQuantity::Loose, "mass of the particles of the body that are part of no fragment";
    }
    SideWord, "side", f64 {
        "positive" => 1.0, "towards larger coordinates";
        "negative" => -1.0, "towards smaller coordinates";
    }
}

/// Space dimensions.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DimensionsWord {}
impl Choices for DimensionsWord {
    type Value = Dimensions;
    const NAME: &'static str = "DimensionsWord";
    const WHAT: &'static str = "number of dimensions";
    fn meant(word: &str) -> Option<&'static str> {
        match word.to_lowercase().as_str() {
            "1" | "one" => Some("1d"),
            "2d" | "2" | "two" | "plane" | "plane strain" => Some("plane-strain"),
            "3" | "three" => Some("3d"),
            _ => None,
        }
    }
    fn table() -> Vec<(&'static str, Dimensions, &'static str)> {
        vec![
            ("1d", Dimensions::One, "motion along x, uniaxial strain; transverse stresses are computed"),
            ("plane-strain", Dimensions::PlaneStrain, "motion in the x-y plane; the out-of-plane stress is computed"),
            ("3d", Dimensions::Three, "three dimensions"),
        ]
    }
}

/// Kernels by key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum KernelWord {}
impl Choices for KernelWord {
    type Value = Kernel;
    const NAME: &'static str = "KernelWord";
    const WHAT: &'static str = "kernel";
    fn table() -> Vec<(&'static str, Kernel, &'static str)> {
        Kernel::ALL.iter().map(|&kernel| (kernel.key(), kernel, kernel.name())).collect()
    }
}

/// Checks of a run by name.
#[derive(Clone, Copy, Debug)]
pub(crate) enum WarningWord {}
impl Choices for WarningWord {
    type Value = WarningKind;
    const NAME: &'static str = "WarningWord";
    const WHAT: &'static str = "check";
    fn table() -> Vec<(&'static str, WarningKind, &'static str)> {
        WarningKind::ALL.into_iter().map(|kind| (kind.info().name, kind, kind.info().meaning)).collect()
    }
}

/// Particle fields by name.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FieldWord {}
impl Choices for FieldWord {
    type Value = &'static FieldInfo;
    const NAME: &'static str = "FieldWord";
    const WHAT: &'static str = "field";
    fn table() -> Vec<(&'static str, &'static FieldInfo, &'static str)> {
        FIELDS.iter().map(|field| (field.name, field, field.meaning)).collect()
    }
}
