//! The bulk data section: every entry read into its type, or noted, or refused by name and line.

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet},
};

use crate::{
    cards::{
        aero::{
            Aero, Body, ControlSurface, IdList, Panel, PanelProperty, RealList, SteadyAero, StripPanel, StripProperty,
        },
        constraint::{DofSet, Equation, Interpolation, RigidBar, RigidBody},
        control::{DampingTable, Factors, Flutter, MachK, ModesRequest, Parameter},
        element::{Bar, BarDefaults, Genel, Rod, Scalar, Shell},
        geometry::{Coordinate, CoordinateKind, Grid, GridDefaults},
        mass::{MassMatrix, PointMass},
        material::Material,
        matrix::{DofMatrices, DofMatrix, PlainMatrices, PlainMatrix},
        property::{BarSection, Laminate, RodSection, ScalarProperty, ShellSection},
        spline::{BeamSpline, SurfaceSpline},
    },
    entry::Entry,
    error::{DeckError, Location, Note, Severity},
    fields::Card,
    known,
};

/// All entries of the bulk data section by type and number.
#[derive(Debug, Clone, Default)]
#[expect(
    missing_docs,
    reason = "each field is named after the cards it holds, which its type documents"
)]
pub struct Bulk {
    pub grids: BTreeMap<u32, Grid>,
    pub scalar_points: BTreeSet<u32>,
    pub coordinates: BTreeMap<u32, Coordinate>,
    pub materials: BTreeMap<u32, Material>,
    pub bar_sections: BTreeMap<u32, BarSection>,
    pub rod_sections: BTreeMap<u32, RodSection>,
    pub shell_sections: BTreeMap<u32, ShellSection>,
    pub laminates: BTreeMap<u32, Laminate>,
    pub spring_values: BTreeMap<u32, ScalarProperty>,
    pub mass_values: BTreeMap<u32, ScalarProperty>,
    pub damper_values: BTreeMap<u32, ScalarProperty>,
    pub bars: BTreeMap<u32, Bar>,
    pub rods: BTreeMap<u32, Rod>,
    pub shells: BTreeMap<u32, Shell>,
    pub springs: BTreeMap<u32, Scalar>,
    pub scalar_masses: BTreeMap<u32, Scalar>,
    pub dampers: BTreeMap<u32, Scalar>,
    pub genels: BTreeMap<u32, Genel>,
    pub mass_matrices: BTreeMap<u32, MassMatrix>,
    pub point_masses: BTreeMap<u32, PointMass>,
    pub rigid_bodies: BTreeMap<u32, RigidBody>,
    pub rigid_bars: BTreeMap<u32, RigidBar>,
    pub interpolations: BTreeMap<u32, Interpolation>,
    /// MPC equations by set.
    pub equations: BTreeMap<u32, Vec<Equation>>,
    /// MPCADD: set and the sets it unites.
    pub equation_unions: BTreeMap<u32, IdList>,
    /// SPC and SPC1 by set.
    pub constraints: BTreeMap<u32, Vec<DofSet>>,
    /// SPCADD: set and the sets it unites.
    pub constraint_unions: BTreeMap<u32, IdList>,
    pub analysis_sets: Vec<DofSet>,
    pub omitted_sets: Vec<DofSet>,
    pub supports: Vec<DofSet>,
    /// SUPORT1 by set.
    pub support_sets: BTreeMap<u32, Vec<DofSet>>,
    pub modes_requests: BTreeMap<u32, ModesRequest>,
    pub aero: Option<Aero>,
    pub steady_aero: Option<SteadyAero>,
    pub panels: BTreeMap<u32, Panel>,
    pub panel_properties: BTreeMap<u32, PanelProperty>,
    pub bodies: BTreeMap<u32, Body>,
    pub strip_panels: BTreeMap<u32, StripPanel>,
    pub strip_properties: BTreeMap<u32, StripProperty>,
    pub real_lists: BTreeMap<u32, RealList>,
    pub box_lists: BTreeMap<u32, IdList>,
    pub point_sets: BTreeMap<u32, IdList>,
    pub control_surfaces: BTreeMap<u32, ControlSurface>,
    pub surface_splines: BTreeMap<u32, SurfaceSpline>,
    pub beam_splines: BTreeMap<u32, BeamSpline>,
    /// Mach numbers and reduced frequencies in the order of the cards, repeated pairs left out.
    pub mach_k: Vec<MachK>,
    /// Where each of [`Bulk::mach_k`] stands.
    pub mach_k_at: Vec<Location>,
    pub flutters: BTreeMap<u32, Flutter>,
    pub factors: BTreeMap<u32, Factors>,
    pub damping_tables: BTreeMap<u32, DampingTable>,
    pub parameters: BTreeMap<String, Parameter>,
    pub dof_matrices: BTreeMap<String, DofMatrix>,
    pub plain_matrices: BTreeMap<String, PlainMatrix>,
}

impl Bulk {
    /// Reads all entries. With `structure_elsewhere` (modes from a file) elements that are not supported are only noted.
    ///
    /// # Errors
    /// Every entry that cannot be read or used.
    pub fn read(entries: &[Entry], structure_elsewhere: bool, notes: &mut Vec<Note>) -> Result<Self, Vec<DeckError>> {
        let sink = RefCell::new(Vec::new());
        let mut errors = Vec::new();
        let mut reader = Reader::default();
        for entry in entries {
            let card = Card::new(entry, &sink);
            match entry.name.as_str() {
                "GRDSET" => keep(GridDefaults::read(&card), &mut reader.grid_defaults, &mut errors),
                "BAROR" => keep(BarDefaults::read(&card), &mut reader.bar_defaults, &mut errors),
                "BEAMOR" => keep(BarDefaults::read(&card), &mut reader.beam_defaults, &mut errors),
                _ => {}
            }
        }
        for entry in entries {
            let card = Card::new(entry, &sink);
            match reader.take(&card) {
                Err(DeckError::Unsupported { .. }) if structure_elsewhere && known::is_structural(&entry.name) => {
                    card.note(Severity::Ignored, "is not needed, since the modes come from a file");
                }
                Err(error) => errors.push(error),
                Ok(()) => {}
            }
        }
        notes.extend(sink.into_inner());
        let mut bulk = reader.bulk;
        match reader.dof_matrices.finish() {
            Ok(found) => bulk.dof_matrices = found,
            Err(error) => errors.push(error),
        }
        match reader.plain_matrices.finish() {
            Ok(found) => bulk.plain_matrices = found,
            Err(error) => errors.push(error),
        }
        if errors.is_empty() { Ok(bulk) } else { Err(errors) }
    }
}

fn keep<T>(read: Result<T, DeckError>, place: &mut T, errors: &mut Vec<DeckError>) {
    match read {
        Ok(value) => *place = value,
        Err(error) => errors.push(error),
    }
}

#[derive(Default)]
struct Reader {
    bulk: Bulk,
    grid_defaults: GridDefaults,
    bar_defaults: BarDefaults,
    beam_defaults: BarDefaults,
    dof_matrices: DofMatrices,
    plain_matrices: PlainMatrices,
}

/// What the maps of [`Bulk`] need to know of a card.
trait Numbered {
    fn id(&self) -> u32;
    fn at(&self) -> &Location;
}

macro_rules! numbered {
    ($($card:ty),* $(,)?) => {
        $(impl Numbered for $card {
            fn id(&self) -> u32 {
                self.id
            }
            fn at(&self) -> &Location {
                &self.at
            }
        })*
    };
}

numbered!(
    Grid,
    Coordinate,
    Material,
    BarSection,
    RodSection,
    ShellSection,
    Laminate,
    ScalarProperty,
    Bar,
    Rod,
    Shell,
    Scalar,
    Genel,
    MassMatrix,
    PointMass,
    RigidBody,
    RigidBar,
    Interpolation,
    IdList,
    ModesRequest,
    Panel,
    PanelProperty,
    Body,
    StripPanel,
    StripProperty,
    RealList,
    ControlSurface,
    SurfaceSpline,
    BeamSpline,
    Flutter,
    Factors,
    DampingTable,
);

fn put<T: Numbered>(map: &mut BTreeMap<u32, T>, card: &Card, value: T) -> Result<(), DeckError> {
    if let Some(first) = map.get(&value.id()) {
        return Err(DeckError::Duplicate {
            at: value.at().clone(),
            card: card.name().to_owned(),
            id: i64::from(value.id()),
            first: first.at().clone(),
        });
    }
    map.insert(value.id(), value);
    Ok(())
}

impl Reader {
    /// One entry into its place.
    fn take(&mut self, card: &Card) -> Result<(), DeckError> {
        let b = &mut self.bulk;
        match card.name() {
            "GRDSET" | "BAROR" | "BEAMOR" => Ok(()),
            "GRID" => put(&mut b.grids, card, Grid::read(card, &self.grid_defaults)?),
            "SPOINT" => {
                b.scalar_points.extend(card.ids(0, "ID")?);
                Ok(())
            }
            "CORD2R" | "CORD2C" | "CORD2S" => {
                let kind = kind_of(card.name());
                put(&mut b.coordinates, card, Coordinate::read_by_points(card, kind)?)
            }
            "CORD1R" | "CORD1C" | "CORD1S" => {
                for system in Coordinate::read_by_grids(card, kind_of(card.name()))? {
                    put(&mut b.coordinates, card, system)?;
                }
                Ok(())
            }
            "MAT1" => put(&mut b.materials, card, Material::read_isotropic(card)?),
            "MAT2" => put(&mut b.materials, card, Material::read_anisotropic(card)?),
            "MAT8" => put(&mut b.materials, card, Material::read_orthotropic(card)?),
            "PBAR" => put(&mut b.bar_sections, card, BarSection::read_bar(card)?),
            "PBARL" => put(&mut b.bar_sections, card, BarSection::read_library(card)?),
            "PBEAM" => put(&mut b.bar_sections, card, BarSection::read_beam(card)?),
            "PROD" => put(&mut b.rod_sections, card, RodSection::read(card)?),
            "PSHELL" => put(&mut b.shell_sections, card, ShellSection::read(card)?),
            "PCOMP" => put(&mut b.laminates, card, Laminate::read(card)?),
            "PELAS" => put_all(&mut b.spring_values, card, ScalarProperty::read_springs(card)?),
            "PMASS" => put_all(&mut b.mass_values, card, ScalarProperty::read_pairs(card)?),
            "PDAMP" => put_all(&mut b.damper_values, card, ScalarProperty::read_pairs(card)?),
            "CBAR" => put(&mut b.bars, card, Bar::read(card, &self.bar_defaults)?),
            "CBEAM" => put(&mut b.bars, card, Bar::read(card, &self.beam_defaults)?),
            "CROD" => put(&mut b.rods, card, Rod::read(card)?),
            "CONROD" => put(&mut b.rods, card, Rod::read_own(card)?),
            "CQUAD4" | "CTRIA3" => put(&mut b.shells, card, Shell::read(card)?),
            "CELAS1" => put(&mut b.springs, card, Scalar::read_1(card)?),
            "CELAS2" => put(&mut b.springs, card, Scalar::read_2(card)?),
            "CELAS3" | "CELAS4" => put_scalar_points(&mut b.springs, card),
            "CMASS1" => put(&mut b.scalar_masses, card, Scalar::read_1(card)?),
            "CMASS2" => put(&mut b.scalar_masses, card, Scalar::read_2(card)?),
            "CMASS3" | "CMASS4" => put_scalar_points(&mut b.scalar_masses, card),
            "CDAMP1" => put(&mut b.dampers, card, Scalar::read_1(card)?),
            "CDAMP2" => put(&mut b.dampers, card, Scalar::read_2(card)?),
            "CDAMP3" | "CDAMP4" => put_scalar_points(&mut b.dampers, card),
            "GENEL" => put(&mut b.genels, card, Genel::read(card)?),
            "CONM1" => put(&mut b.mass_matrices, card, MassMatrix::read(card)?),
            "CONM2" => put(&mut b.point_masses, card, PointMass::read(card)?),
            "RBE2" => put(&mut b.rigid_bodies, card, RigidBody::read(card)?),
            "RBAR" => put(&mut b.rigid_bars, card, RigidBar::read(card)?),
            "RBE3" => put(&mut b.interpolations, card, Interpolation::read(card)?),
            "MPC" => {
                let equation = Equation::read(card)?;
                b.equations.entry(equation.set).or_default().push(equation);
                Ok(())
            }
            "MPCADD" => put(&mut b.equation_unions, card, IdList::read(card)?),
            "SPC" => {
                b.constraints
                    .entry(card.id(0, "SID")?)
                    .or_default()
                    .extend(DofSet::read_spc(card)?);
                Ok(())
            }
            "SPC1" => {
                b.constraints
                    .entry(card.id(0, "SID")?)
                    .or_default()
                    .push(DofSet::read_list(card, 1)?);
                Ok(())
            }
            "SPCADD" => put(&mut b.constraint_unions, card, IdList::read(card)?),
            "ASET" => {
                b.analysis_sets.extend(DofSet::read_pairs(card, 0)?);
                Ok(())
            }
            "ASET1" => {
                b.analysis_sets.push(DofSet::read_list(card, 0)?);
                Ok(())
            }
            "OMIT" => {
                b.omitted_sets.extend(DofSet::read_pairs(card, 0)?);
                Ok(())
            }
            "OMIT1" => {
                b.omitted_sets.push(DofSet::read_list(card, 0)?);
                Ok(())
            }
            "SUPORT" => {
                b.supports.extend(DofSet::read_pairs(card, 0)?);
                Ok(())
            }
            "SUPORT1" => {
                b.support_sets
                    .entry(card.id(0, "SID")?)
                    .or_default()
                    .extend(DofSet::read_pairs(card, 1)?);
                Ok(())
            }
            "EIGR" => put(&mut b.modes_requests, card, ModesRequest::read_eigr(card)?),
            "EIGRL" => put(&mut b.modes_requests, card, ModesRequest::read_eigrl(card)?),
            "PARAM" => take_parameter(b, card),
            "DMIG" => self.dof_matrices.read(card),
            "DMI" => self.plain_matrices.read(card),
            _ => self.take_aero(card),
        }
    }

    /// The entries of aerodynamics and flutter, and those that are noted or refused.
    fn take_aero(&mut self, card: &Card) -> Result<(), DeckError> {
        let b = &mut self.bulk;
        match card.name() {
            "AERO" => {
                let aero = Aero::read(card)?;
                if let Some(first) = &b.aero {
                    return Err(card.error(format!("a deck has one AERO card; the first stands at {}", first.at)));
                }
                b.aero = Some(aero);
                Ok(())
            }
            "AEROS" => {
                b.steady_aero = Some(SteadyAero::read(card)?);
                Ok(())
            }
            "CAERO1" => put(&mut b.panels, card, Panel::read(card)?),
            "PAERO1" => put(&mut b.panel_properties, card, PanelProperty::read(card)?),
            "CAERO2" => {
                put(&mut b.bodies, card, Body::read(card)?)?;
                Err(card.unsupported(
                    "slender bodies are not computed; model the body by crossed CAERO1 panels or leave it out",
                ))
            }
            "CAERO4" => put(&mut b.strip_panels, card, StripPanel::read(card)?),
            "PAERO4" => put(&mut b.strip_properties, card, StripProperty::read(card)?),
            "AEFACT" => put(&mut b.real_lists, card, RealList::read(card)?),
            "AELIST" => put(&mut b.box_lists, card, IdList::read(card)?),
            "AESURF" => put(&mut b.control_surfaces, card, ControlSurface::read(card)?),
            "SET1" => put(&mut b.point_sets, card, IdList::read(card)?),
            "SPLINE1" | "SPLINE4" => put(&mut b.surface_splines, card, SurfaceSpline::read(card)?),
            "SPLINE2" | "SPLINE5" => put(&mut b.beam_splines, card, BeamSpline::read(card)?),
            "MKAERO1" => take_mach_k(b, card, MachK::read_combinations(card)?),
            "MKAERO2" => take_mach_k(b, card, MachK::read_pairs(card)?),
            "FLUTTER" => put(&mut b.flutters, card, Flutter::read(card)?),
            "FLFACT" => put(&mut b.factors, card, Factors::read(card)?),
            "TABDMP1" => put(&mut b.damping_tables, card, DampingTable::read(card)?),
            name if known::is_without_effect(name) => {
                card.note(Severity::Ignored, "has no effect on modes or flutter");
                Ok(())
            }
            name => Err(card.unsupported(known::why_not(name))),
        }
    }
}

fn put_all(map: &mut BTreeMap<u32, ScalarProperty>, card: &Card, values: Vec<ScalarProperty>) -> Result<(), DeckError> {
    values.into_iter().try_for_each(|value| put(map, card, value))
}

/// CELAS3 and its like may hold one element; CELAS3, CMASS3 and CDAMP3 of old decks two, of four fields each.
fn put_scalar_points(map: &mut BTreeMap<u32, Scalar>, card: &Card) -> Result<(), DeckError> {
    if card.has(4) {
        return Err(card.unsupported("two elements on one card; write each on its own"));
    }
    put(map, card, Scalar::read_scalar_points(card, card.name().ends_with('4'))?)
}

fn take_mach_k(bulk: &mut Bulk, card: &Card, pairs: Vec<MachK>) -> Result<(), DeckError> {
    for pair in pairs {
        if !bulk.mach_k.contains(&pair) {
            bulk.mach_k.push(pair);
            bulk.mach_k_at.push(card.at());
        }
    }
    Ok(())
}

fn take_parameter(bulk: &mut Bulk, card: &Card) -> Result<(), DeckError> {
    let parameter = Parameter::read(card)?;
    if !known::is_used_parameter(&parameter.name) {
        card.note(
            Severity::Ignored,
            format!("{} has no effect on modes or flutter", parameter.name),
        );
    }
    if let Some(first) = bulk.parameters.get(&parameter.name)
        && first.value != parameter.value
    {
        return Err(card.error(format!(
            "{} is {} here and {} at {}; keep one",
            parameter.name, parameter.value, first.value, first.at
        )));
    }
    bulk.parameters.insert(parameter.name.clone(), parameter);
    Ok(())
}

fn kind_of(name: &str) -> CoordinateKind {
    match name.as_bytes().last() {
        Some(b'C') => CoordinateKind::Cylindrical,
        Some(b'S') => CoordinateKind::Spherical,
        _ => CoordinateKind::Rectangular,
    }
}
