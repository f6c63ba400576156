//! Heat that flows.

use super::shape::direction;
use super::{Names, exactly_one};
use crate::fault::{Fault, Problems};
use crate::raw::{RawHeatBoundary, RawThermal};
use crate::value::{Flag, Given, Temperature};
use sphorge_engine::model::{Dimensions, HeatBoundary, HeatBoundaryKind, Thermal};
use sphorge_physics::parameter::Bound;

/// Conduction and its boundaries.
pub(crate) fn thermal(
    raw: Option<&RawThermal>,
    dimensions: Dimensions,
    bodies: &Names,
    regions: &Names,
    problems: &mut Problems,
) -> Option<Thermal> {
    let Some(raw) = raw else { return Some(Thermal::default()) };
    let mut flag = |given: &Option<Flag>| given.as_ref().map_or(Some(true), |f| f.get(problems));
    let (conduction, mechanics) = (flag(&raw.conduction), flag(&raw.mechanics));
    Names::collect("heat boundary", raw.boundary.iter().map(|b| &b.name), problems);
    let boundaries: Vec<_> = raw.boundary.iter().map(|b| boundary(b, dimensions, bodies, regions, problems)).collect();
    let (conduction, mechanics) = (conduction?, mechanics?);
    if !conduction && !mechanics {
        let fault =
            Fault::new("conflict", "the bodies do not move and no heat flows", raw.span(), "nothing to compute");
        problems.push(fault.help("leave out `conduction = false` or `mechanics = false`"));
        return None;
    }
    Some(Thermal { conduction, mechanics, boundaries: boundaries.into_iter().collect::<Option<_>>()? })
}

fn kelvin(given: &Given<Temperature>, problems: &mut Problems) -> Option<f64> {
    given.within(Bound::NonNegative, problems)
}

fn boundary(
    raw: &RawHeatBoundary,
    dimensions: Dimensions,
    bodies: &Names,
    regions: &Names,
    problems: &mut Problems,
) -> Option<HeatBoundary> {
    enum Kind<'a> {
        Hold(&'a Given<Temperature>),
        Surface(&'a Given<Temperature>),
        Flux(&'a Given<crate::value::HeatFlux>),
        Convection(&'a crate::raw::RawConvection),
    }
    let body = raw.body.as_ref().map_or(Some(None), |b| bodies.find(b, problems).map(Some));
    let region = raw.region.as_ref().map_or(Some(None), |r| regions.find(r, problems).map(Some));
    let normal = raw.normal.as_ref().map_or(Some(None), |n| direction(n, "normal", dimensions, problems).map(Some));
    let options = vec![
        ("hold", raw.hold.as_ref().map(Kind::Hold)),
        ("surface-temperature", raw.surface_temperature.as_ref().map(Kind::Surface)),
        ("flux", raw.flux.as_ref().map(Kind::Flux)),
        ("convection", raw.convection.as_ref().map(Kind::Convection)),
    ];
    let kind = match exactly_one(options, "a heat boundary", raw.name.span(), problems)? {
        Kind::Hold(_) if raw.normal.is_some() => {
            let at = raw.normal.as_ref().map_or(0..0, |n| n.span.clone());
            let fault = Fault::new("conflict", "`hold` and `normal` are given together", at, "names faces");
            problems.push(fault.help(
                "`hold` keeps particles at a temperature, not faces: leave `normal` out, or use `surface-temperature` in place of `hold`",
            ));
            return None;
        }
        Kind::Hold(temperature) => HeatBoundaryKind::HeldTemperature(kelvin(temperature, problems)?),
        Kind::Surface(temperature) => HeatBoundaryKind::SurfaceTemperature(kelvin(temperature, problems)?),
        Kind::Flux(flux) => HeatBoundaryKind::Flux(flux.si(problems)?),
        Kind::Convection(table) => {
            let coefficient = table.coefficient.within(Bound::NonNegative, problems);
            let ambient = kelvin(&table.ambient, problems);
            HeatBoundaryKind::Convection { coefficient: coefficient?, ambient: ambient? }
        }
    };
    let name = raw.name.text(problems)?.to_owned();
    Some(HeatBoundary { name, body: body?, region: region?, normal: normal?, kind })
}
