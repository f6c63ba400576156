//! Colour maps.

/// Red, green, blue.
pub(crate) type Rgb = [u8; 3];

/// How a value becomes a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// Perceptually uniform from dark blue to yellow (viridis of Smith and van der Walt), also in grey and for the
    /// colour-blind.
    #[default]
    Viridis,
    /// Perceptually uniform from black through red to yellow (inferno of the same authors).
    Inferno,
    /// From blue over light grey to red: deviation from a middle (Moreland 2009).
    Diverging,
}

/// Polynomials of degree six through viridis and inferno, by M. Zucker (CC0); within 1/50 of the tables.
const VIRIDIS: [[f64; 3]; 7] = [
    [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
    [0.1050930431085774, 1.404613529898575, 1.384590162594685],
    [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
    [-4.634230498983486, -5.799100973351585, -19.33244095627987],
    [6.228269936347081, 14.17993336680509, 56.69055260068105],
    [4.776384997670288, -13.74514537774601, -65.35303263337234],
    [-5.435455855934631, 4.645852612178535, 26.3124352495832],
];
const INFERNO: [[f64; 3]; 7] = [
    [0.0002189403691192265, 0.001651004631001012, -0.01948089843709184],
    [0.1065134194856116, 0.5639564367884091, 3.932712388889277],
    [11.60249308247187, -3.972853965665698, -15.9423941062914],
    [-41.70399613139459, 17.43639888205313, 44.35414519872813],
    [77.162935699427, -33.40235894210092, -81.80730925738993],
    [-71.31942824499214, 32.62606426397723, 73.20951985803202],
    [25.13112622477341, -12.24266895238567, -23.07032500287172],
];
/// Moreland's cool-warm map at nine equidistant places.
const COOL_WARM: [Rgb; 9] = [
    [59, 76, 192],
    [98, 130, 234],
    [141, 176, 254],
    [184, 208, 249],
    [221, 221, 221],
    [245, 196, 173],
    [244, 154, 123],
    [222, 96, 77],
    [180, 4, 38],
];

impl ColorMap {
    /// Colour at `t`, clamped to 0 to 1.
    pub(crate) fn color(self, t: f64) -> Rgb {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        match self {
            Self::Viridis => polynomial(&VIRIDIS, t),
            Self::Inferno => polynomial(&INFERNO, t),
            Self::Diverging => {
                let place = t * (COOL_WARM.len() - 1) as f64;
                let k = (place as usize).min(COOL_WARM.len() - 2);
                let share = place - k as f64;
                std::array::from_fn(|c| {
                    let (a, b) = (f64::from(COOL_WARM[k][c]), f64::from(COOL_WARM[k + 1][c]));
                    (a + share * (b - a)).round() as u8
                })
            }
        }
    }
}

fn polynomial(coefficients: &[[f64; 3]; 7], t: f64) -> Rgb {
    std::array::from_fn(|c| {
        let value = coefficients.iter().rev().fold(0.0, |sum, row| sum * t + row[c]);
        (255.0 * value.clamp(0.0, 1.0)).round() as u8
    })
}

/// Line colours that the colour-blind can tell apart (Okabe & Ito 2008), the yellow left out on white.
pub(crate) const LINES: [Rgb; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233], [90, 90, 90]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_meet_their_tables() {
        // Viridis and inferno of matplotlib at 0, 0.25, 0.5, 0.75, 1.
        let viridis = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
        let inferno = [[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]];
        for (map, table) in [(ColorMap::Viridis, viridis), (ColorMap::Inferno, inferno)] {
            for (k, expected) in table.iter().enumerate() {
                let color = map.color(k as f64 / 4.0);
                for c in 0..3 {
                    assert!(color[c].abs_diff(expected[c]) <= 8, "{map:?} {k}: {color:?} {expected:?}");
                }
            }
        }
        assert_eq!(ColorMap::Diverging.color(0.5), [221, 221, 221]);
        assert_eq!(ColorMap::Diverging.color(7.0), [180, 4, 38]);
    }
}
