//! The setup as metadata records: names and numbers in text, as any MCAP tool shows them.
//!
//! Numbers are written with the fewest digits that give the same double back. The last record, `dip.check`, holds a
//! CRC-32 of all others, since MCAP has no checksum for metadata in a file that was cut short.

use std::collections::BTreeMap;

use crate::motion::{CoordinateKind, Harmonic, Law, MotionCoordinate, StructuralMode};
use crate::schema::FORMAT;
use crate::setup::{Provenance, References, Setup};

/// A metadata record: its name and its entries.
pub(crate) type Entry = (String, BTreeMap<String, String>);

pub(crate) const FILE: &str = "dip.file";
pub(crate) const REFERENCES: &str = "dip.references";
pub(crate) const CASE: &str = "dip.case";
pub(crate) const MOTION: &str = "dip.motion.";
pub(crate) const CHECK: &str = "dip.check";
pub(crate) const END: &str = "dip.end";

/// Text of one record under way.
#[derive(Default)]
struct Map(BTreeMap<String, String>);

impl Map {
    fn text(&mut self, key: &str, value: impl Into<String>) {
        self.0.insert(key.to_owned(), value.into());
    }
    fn number(&mut self, key: &str, value: f64) {
        self.text(key, format!("{value:?}"));
    }
    fn vector(&mut self, key: &str, value: [f64; 3]) {
        self.text(key, value.map(|v| format!("{v:?}")).join(" "));
    }
}

/// Everything of a setup but the surface. `dip.check` is the last one.
pub(crate) fn encode(setup: &Setup) -> Vec<Entry> {
    let mut entries = vec![
        (FILE.to_owned(), file(&setup.provenance)),
        (REFERENCES.to_owned(), references(&setup.references)),
        (CASE.to_owned(), case(&setup.provenance)),
    ];
    for (n, coordinate) in setup.motion.iter().enumerate() {
        entries.push((format!("{MOTION}{}", n + 1), motion(coordinate)));
    }
    let sum = checksum(entries.iter().map(|(name, map)| (name.as_str(), map)));
    entries.push((
        CHECK.to_owned(),
        BTreeMap::from([("crc32".to_owned(), format!("{sum:08x}"))]),
    ));
    entries
}

fn file(provenance: &Provenance) -> BTreeMap<String, String> {
    let mut map = Map::default();
    map.text("format", FORMAT);
    map.text("program", provenance.program.clone());
    map.text("version", provenance.version.clone());
    map.text("mesh_sha256", provenance.mesh_sha256.clone());
    map.0
}

fn case(provenance: &Provenance) -> BTreeMap<String, String> {
    let mut map = Map::default();
    map.text("name", provenance.case_name.clone());
    map.text("text", provenance.case_text.clone());
    map.0
}

fn references(r: &References) -> BTreeMap<String, String> {
    let mut map = Map::default();
    map.text("model", r.model.clone());
    map.number("mach", r.mach);
    map.number("speed_m_s", r.speed_m_s);
    map.number("density_kg_m3", r.density_kg_m3);
    map.number("pressure_pa", r.pressure_pa);
    map.number("gamma", r.gamma);
    if let Some(reynolds) = r.reynolds {
        map.number("reynolds", reynolds);
    }
    map.number("alpha_deg", r.alpha_deg);
    map.number("reference_semichord_m", r.reference_semichord_m);
    map.number("reference_chord_m", r.reference_chord_m);
    map.number("reference_area_m2", r.reference_area_m2);
    map.number("span_m", r.span_m);
    map.vector("moment_point_m", r.moment_point_m);
    map.number("grid_unit_m", r.grid_unit_m);
    map.text("half_model", r.half_model.to_string());
    map.number("time_step_s", r.time_step_s);
    if let Some(steps) = r.steps_per_cycle {
        map.text("steps_per_cycle", steps.to_string());
    }
    if let Some(cycles) = r.cycles_asked {
        map.number("cycles_asked", cycles);
    }
    map.number("orders_asked", r.orders_asked);
    map.0
}

fn motion(coordinate: &MotionCoordinate) -> BTreeMap<String, String> {
    let mut map = Map::default();
    map.text("name", coordinate.name.clone());
    map.text("kind", coordinate.kind.name());
    map.text("unit", coordinate.kind.unit());
    match coordinate.kind {
        CoordinateKind::Pitch {
            axis_point_m,
            axis_direction,
        }
        | CoordinateKind::Control {
            axis_point_m,
            axis_direction,
        } => {
            map.vector("axis_point_m", axis_point_m);
            map.vector("axis_direction", axis_direction);
        }
        CoordinateKind::Plunge { direction } => map.vector("direction", direction),
        CoordinateKind::Mode => {}
    }
    map.text("law", coordinate.law.name());
    match &coordinate.law {
        Law::Harmonic {
            mean,
            phase_origin_s,
            harmonics,
        } => {
            map.number("mean", *mean);
            map.number("phase_origin_s", *phase_origin_s);
            map.text("harmonics", harmonics.len().to_string());
            for (n, h) in harmonics.iter().enumerate() {
                map.number(&format!("omega_rad_s.{}", n + 1), h.omega_rad_s);
                map.number(&format!("amplitude.{}", n + 1), h.amplitude);
                map.number(&format!("phase_rad.{}", n + 1), h.phase_rad);
            }
        }
        Law::Pulse {
            mean,
            amplitude,
            start_s,
            duration_s,
            formula,
        }
        | Law::Ramp {
            mean,
            amplitude,
            start_s,
            duration_s,
            formula,
        } => {
            map.number("mean", *mean);
            map.number("amplitude", *amplitude);
            map.number("start_s", *start_s);
            map.number("duration_s", *duration_s);
            map.text("formula", formula.clone());
        }
        Law::Free => {}
    }
    if let Some(mode) = &coordinate.mode {
        map.text("mode_number", mode.number.to_string());
        map.number("mode_omega_rad_s", mode.omega_rad_s);
        map.number("mode_generalized_mass_kg", mode.generalized_mass_kg);
        map.number("mode_damping_ratio", mode.damping_ratio);
    }
    map.0
}

/// CRC-32 of records in the given order: lengths and bytes of names, keys and values.
pub(crate) fn checksum<'a>(entries: impl Iterator<Item = (&'a str, &'a BTreeMap<String, String>)>) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    let mut feed = |text: &str| {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    for (name, map) in entries {
        feed(name);
        for (key, value) in map {
            feed(key);
            feed(value);
        }
    }
    hasher.finalize()
}

/// Entries of one record, by name.
struct Record<'a> {
    name: &'a str,
    map: &'a BTreeMap<String, String>,
}

impl Record<'_> {
    fn optional_text(&self, key: &str) -> Option<&str> {
        self.map.get(key).map(String::as_str)
    }
    fn text(&self, key: &str) -> Result<&str, String> {
        self.optional_text(key)
            .ok_or_else(|| format!("metadata record `{}` lacks `{key}`", self.name))
    }
    fn parse<T: std::str::FromStr>(&self, key: &str, needed: &str) -> Result<T, String> {
        let text = self.text(key)?;
        text.parse()
            .map_err(|_| format!("metadata record `{}`: {key} = `{text}`, needed {needed}", self.name))
    }
    fn optional<T: std::str::FromStr>(&self, key: &str, needed: &str) -> Result<Option<T>, String> {
        self.optional_text(key).map(|_| self.parse(key, needed)).transpose()
    }
    fn number(&self, key: &str) -> Result<f64, String> {
        self.parse(key, "a number")
    }
    fn vector(&self, key: &str) -> Result<[f64; 3], String> {
        let text = self.text(key)?;
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|t| t.parse().ok()).collect();
        <[f64; 3]>::try_from(numbers).map_err(|_| {
            format!(
                "metadata record `{}`: {key} = `{text}`, needed three numbers",
                self.name
            )
        })
    }
}

/// The setup without its surface, from the records of a file by name. `whole` says that nothing in the file is known to be
/// changed or missing: then other programs may have left the checksum out.
pub(crate) fn decode(
    records: &BTreeMap<String, BTreeMap<String, String>>,
    whole: bool,
) -> Result<(References, Vec<MotionCoordinate>, Provenance), String> {
    let record = |name: &'static str| {
        records
            .get(name)
            .map(|map| Record { name, map })
            .ok_or_else(|| format!("metadata record `{name}` is missing"))
    };
    let (file, case) = (record(FILE)?, record(CASE)?);
    let provenance = Provenance {
        program: file.text("program")?.to_owned(),
        version: file.text("version")?.to_owned(),
        mesh_sha256: file.text("mesh_sha256")?.to_owned(),
        case_name: case.text("name")?.to_owned(),
        case_text: case.text("text")?.to_owned(),
    };
    let mut motion = Vec::new();
    let mut listed = vec![FILE.to_owned(), REFERENCES.to_owned(), CASE.to_owned()];
    for n in 1.. {
        let name = format!("{MOTION}{n}");
        let Some(map) = records.get(&name) else { break };
        motion.push(decode_motion(&Record { name: &name, map })?);
        listed.push(name);
    }
    let sum = checksum(
        listed
            .iter()
            .filter_map(|name| records.get(name).map(|map| (name.as_str(), map))),
    );
    match record(CHECK) {
        Ok(saved) if saved.text("crc32")? != format!("{sum:08x}") => {
            return Err("the metadata do not agree with their checksum".to_owned());
        }
        Err(missing) if !whole => {
            return Err(format!("{missing}, which a file that is not whole cannot do without"));
        }
        _ => {}
    }
    Ok((decode_references(&record(REFERENCES)?)?, motion, provenance))
}

fn decode_references(r: &Record<'_>) -> Result<References, String> {
    Ok(References {
        model: r.text("model")?.to_owned(),
        mach: r.number("mach")?,
        speed_m_s: r.number("speed_m_s")?,
        density_kg_m3: r.number("density_kg_m3")?,
        pressure_pa: r.number("pressure_pa")?,
        gamma: r.number("gamma")?,
        reynolds: r.optional("reynolds", "a number")?,
        alpha_deg: r.number("alpha_deg")?,
        reference_semichord_m: r.number("reference_semichord_m")?,
        reference_chord_m: r.number("reference_chord_m")?,
        reference_area_m2: r.number("reference_area_m2")?,
        span_m: r.number("span_m")?,
        moment_point_m: r.vector("moment_point_m")?,
        grid_unit_m: r.number("grid_unit_m")?,
        half_model: r.parse("half_model", "true or false")?,
        time_step_s: r.number("time_step_s")?,
        steps_per_cycle: r.optional("steps_per_cycle", "a whole number")?,
        cycles_asked: r.optional("cycles_asked", "a number")?,
        orders_asked: r.number("orders_asked")?,
    })
}

fn decode_motion(r: &Record<'_>) -> Result<MotionCoordinate, String> {
    let unknown = |key: &str, got: &str, needed: &str| {
        format!("metadata record `{}`: {key} = `{got}`, needed one of {needed}", r.name)
    };
    let kind = match r.text("kind")? {
        "pitch" => CoordinateKind::Pitch {
            axis_point_m: r.vector("axis_point_m")?,
            axis_direction: r.vector("axis_direction")?,
        },
        "plunge" => CoordinateKind::Plunge {
            direction: r.vector("direction")?,
        },
        "mode" => CoordinateKind::Mode,
        "control" => CoordinateKind::Control {
            axis_point_m: r.vector("axis_point_m")?,
            axis_direction: r.vector("axis_direction")?,
        },
        other => return Err(unknown("kind", other, "pitch, plunge, mode, control")),
    };
    let law = match r.text("law")? {
        "harmonic" => {
            let count: usize = r.parse("harmonics", "a whole number")?;
            let mut harmonics = Vec::new();
            for n in 1..=count {
                harmonics.push(Harmonic {
                    omega_rad_s: r.number(&format!("omega_rad_s.{n}"))?,
                    amplitude: r.number(&format!("amplitude.{n}"))?,
                    phase_rad: r.number(&format!("phase_rad.{n}"))?,
                });
            }
            Law::Harmonic {
                mean: r.number("mean")?,
                phase_origin_s: r.number("phase_origin_s")?,
                harmonics,
            }
        }
        "pulse" => Law::Pulse {
            mean: r.number("mean")?,
            amplitude: r.number("amplitude")?,
            start_s: r.number("start_s")?,
            duration_s: r.number("duration_s")?,
            formula: r.text("formula")?.to_owned(),
        },
        "ramp" => Law::Ramp {
            mean: r.number("mean")?,
            amplitude: r.number("amplitude")?,
            start_s: r.number("start_s")?,
            duration_s: r.number("duration_s")?,
            formula: r.text("formula")?.to_owned(),
        },
        "free" => Law::Free,
        other => return Err(unknown("law", other, "harmonic, pulse, ramp, free")),
    };
    let mode = match r.optional("mode_number", "a whole number")? {
        None => None,
        Some(number) => Some(StructuralMode {
            number,
            omega_rad_s: r.number("mode_omega_rad_s")?,
            generalized_mass_kg: r.number("mode_generalized_mass_kg")?,
            damping_ratio: r.number("mode_damping_ratio")?,
        }),
    };
    Ok(MotionCoordinate {
        name: r.text("name")?.to_owned(),
        kind,
        law,
        shape_m: Vec::new(),
        mode,
    })
}
