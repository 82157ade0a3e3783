//! From `[motion]` to what the flow solver moves and what a recording says of it.

use super::{deformation, modes, surface};
use crate::exit::Stop;

use dip_case::Document;
use dip_case::file::{Amount, MotionKind, MotionLaw, PitchFile};
use dip_case::units::{Angle, Kind, Length, UnitError};
use dip_grid::MultiBlock;
use dip_pmb::motion as pmb;
use dip_pmb::moving::Nodes;
use dip_record as record;
use nalgebra::Vector3;

/// Frequencies and steps, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Circular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Reduced frequency omega b / U.
    pub reduced_frequency: f64,
    /// Time step, s.
    pub step_s: f64,
    /// Steps in a cycle; 0 where the motion is not periodic.
    pub steps_per_cycle: usize,
    /// Steps at most.
    pub steps: usize,
}

/// A motion as solver and recording want it.
#[derive(Debug, Clone)]
pub struct Prescribed {
    /// For the flow solver: time in metres over stream speed.
    pub motion: pmb::Motion,
    /// For the recording, without the shape: see [`Prescribed::recorded`].
    pub coordinate: record::MotionCoordinate,
    /// Displacement of every node for a unit of the coordinate, where the shape is not rigid.
    pub field: Option<Nodes>,
    /// Amplitude of the first sine, pulse or ramp, SI.
    pub amplitude: f64,
}

impl Prescribed {
    /// The coordinate as a recording has it, with its shape on the walls of the grid where it is not rigid.
    pub fn recorded(&self, grid: &MultiBlock) -> record::MotionCoordinate {
        record::MotionCoordinate {
            shape_m: self
                .field
                .as_ref()
                .map_or_else(Vec::new, |f| surface::at_walls(grid, f)),
            ..self.coordinate.clone()
        }
    }
}

/// Frequencies and steps of a case.
///
/// # Errors
/// Frequency missing or given twice, values out of their ranges.
pub fn clock(document: &Document, file: &PitchFile, speed_m_s: f64) -> Result<Clock, Stop> {
    let m = &file.motion;
    let b = file.reference.semichord.map_or(0.5 * file.reference.chord.0, |b| b.0);
    let wrong = |key: &str, message: String, help: &str| Err(document.error(key, message, help).into());
    if b.is_nan() || b <= 0.0 {
        return wrong(
            "reference.semichord",
            format!("{b} m: needed a positive length"),
            "half the root chord, as a rule",
        );
    }
    let omega = match (m.frequency, m.reduced_frequency) {
        (Some(f), None) => f.0,
        (None, Some(k)) => k * speed_m_s / b,
        (Some(_), Some(_)) => {
            let message = "both frequency and reduced_frequency".to_owned();
            return wrong("motion.reduced_frequency", message, "give one of them");
        }
        (None, None) => {
            let message = "neither frequency nor reduced_frequency".to_owned();
            return wrong(
                "motion",
                message,
                "frequency = \"17.98 Hz\", or reduced_frequency = 0.136 (omega b / U)",
            );
        }
    };
    if !(omega > 0.0 && omega.is_finite()) {
        return wrong(
            "motion",
            format!("frequency {omega} rad/s: needed a positive value"),
            "frequency = \"17.98 Hz\"",
        );
    }
    if !(4..=100_000).contains(&m.steps_per_cycle) {
        let message = format!("{} steps per cycle: needed 4 to 100000", m.steps_per_cycle);
        return wrong(
            "motion.steps_per_cycle",
            message,
            "40 resolve a first harmonic to some tenths of a per cent",
        );
    }
    if m.cycles == 0 || m.cycles > 100_000 {
        return wrong(
            "motion.cycles",
            format!("{} cycles: needed 1 to 100000", m.cycles),
            "6 are a good start",
        );
    }
    for (key, value) in [("tolerance", m.tolerance), ("duration", m.duration)] {
        if !(value >= 0.0 && value.is_finite()) {
            return wrong(
                &format!("motion.{key}"),
                format!("{value}: needed a number from zero on"),
                "leave it out for the default",
            );
        }
    }
    if m.law != MotionLaw::Harmonic && m.duration == 0.0 {
        return wrong(
            "motion.duration",
            "0: a pulse or ramp takes time".to_owned(),
            "duration = 1 is one period of `frequency`",
        );
    }
    Ok(Clock {
        omega_rad_s: omega,
        reduced_frequency: omega * b / speed_m_s,
        step_s: std::f64::consts::TAU / omega / m.steps_per_cycle as f64,
        steps_per_cycle: if m.law == MotionLaw::Harmonic {
            m.steps_per_cycle
        } else {
            0
        },
        steps: m.steps_per_cycle * m.cycles,
    })
}

/// The motion of a case on its grid.
///
/// # Errors
/// What is wrong in `[motion]` or `[modes]`.
pub fn prescribed(
    document: &Document,
    file: &PitchFile,
    grid: &MultiBlock,
    clock: &Clock,
    speed_m_s: f64,
) -> Result<Prescribed, Stop> {
    let m = &file.motion;
    let values = Values { document, kind: m.kind };
    let amplitude = values.read("motion.amplitude", &m.amplitude)?;
    let mean = m.mean.as_ref().map_or(Ok(0.0), |v| values.read("motion.mean", v))?;
    let mut harmonics = vec![record::Harmonic {
        omega_rad_s: clock.omega_rad_s,
        amplitude,
        phase_rad: m.phase.map_or(0.0, |p| p.0),
    }];
    for (n, h) in m.harmonic.iter().enumerate() {
        let key = format!("motion.harmonic.{n}");
        if h.multiple == 0 || m.law != MotionLaw::Harmonic {
            let message = "a sine needs a whole multiple of the frequency from 1 on, and a harmonic motion";
            return Err(document.error(&key, message, "multiple = 2").into());
        }
        // At half the steps of a cycle and above, a sine cannot be told from one of a lower frequency.
        if 2 * h.multiple >= m.steps_per_cycle {
            let message = format!(
                "multiple = {} with {} steps per cycle: needed less than half of them",
                h.multiple, m.steps_per_cycle
            );
            let help = "more motion.steps_per_cycle";
            return Err(document.error(&format!("{key}.multiple"), message, help).into());
        }
        harmonics.push(record::Harmonic {
            omega_rad_s: h.multiple as f64 * clock.omega_rad_s,
            amplitude: values.read(&format!("{key}.amplitude"), &h.amplitude)?,
            phase_rad: h.phase.map_or(0.0, |p| p.0),
        });
    }
    // The grid is in metres: its time is seconds times speed.
    let duration_s = m.duration * std::f64::consts::TAU / clock.omega_rad_s;
    let (law, told) = match m.law {
        MotionLaw::Harmonic => (
            pmb::Law::Harmonic {
                mean,
                terms: harmonics
                    .iter()
                    .map(|h| pmb::Harmonic {
                        amplitude: h.amplitude,
                        omega: h.omega_rad_s / speed_m_s,
                        phase: h.phase_rad,
                    })
                    .collect(),
            },
            record::Law::Harmonic {
                mean,
                phase_origin_s: 0.0,
                harmonics,
            },
        ),
        MotionLaw::Pulse => (
            pmb::Law::Pulse {
                mean,
                amplitude,
                duration: duration_s * speed_m_s,
            },
            record::Law::Pulse {
                mean,
                amplitude,
                start_s: 0.0,
                duration_s,
                formula: "mean + amplitude exp(1 - 1/(1 - s^2)), s = 2 t/duration - 1".to_owned(),
            },
        ),
        MotionLaw::Ramp => (
            pmb::Law::Ramp {
                from: mean,
                to: mean + amplitude,
                duration: duration_s * speed_m_s,
            },
            record::Law::Ramp {
                mean,
                amplitude,
                start_s: 0.0,
                duration_s,
                formula: "mean + amplitude (10 s^3 - 15 s^4 + 6 s^5), s = t/duration".to_owned(),
            },
        ),
    };
    let shape = shape(document, file, grid)?;
    let coordinate = record::MotionCoordinate {
        name: shape.name.clone(),
        kind: shape.kind,
        law: told,
        shape_m: Vec::new(),
        mode: shape.mode,
    };
    let field = match &shape.shape {
        pmb::Shape::Field(nodes) => Some(nodes.clone()),
        _ => None,
    };
    Ok(Prescribed {
        motion: pmb::Motion {
            rest: Nodes::of(grid),
            coordinates: vec![pmb::Coordinate {
                name: shape.name,
                shape: shape.shape,
                law,
                blocks: None,
            }],
        },
        coordinate,
        field,
        amplitude,
    })
}

/// Reads amounts as what moves has them.
struct Values<'a> {
    document: &'a Document,
    kind: MotionKind,
}

impl Values<'_> {
    fn read(&self, key: &str, amount: &Amount) -> Result<f64, Stop> {
        let read: Result<f64, UnitError> = match self.kind {
            MotionKind::Pitch | MotionKind::Control => amount.value::<Angle>(),
            MotionKind::Plunge => amount.value::<Length>(),
            MotionKind::Mode => match amount {
                Amount::Number(v) => Ok(*v),
                Amount::Text(text) => text.trim().parse::<f64>().map_or_else(|_| amount.value::<Length>(), Ok),
            },
        };
        let example = match self.kind {
            MotionKind::Pitch | MotionKind::Control => Angle::EXAMPLE,
            MotionKind::Plunge => Length::EXAMPLE,
            MotionKind::Mode => "0.001 (no unit: the shape carries the metres)",
        };
        let help = format!("such as {example}");
        if let (MotionKind::Mode, Amount::Text(text), Err(_)) = (self.kind, amount, &read) {
            return Err(self
                .document
                .error(key, format!("{text:?} is not a number"), help)
                .into());
        }
        match read {
            Ok(v) if v.is_finite() => Ok(v),
            Ok(v) => Err(self
                .document
                .error(key, format!("{v}: needed a finite value"), help)
                .into()),
            Err(e) => Err(self.document.error(key, e.to_string(), help).into()),
        }
    }
}

struct NamedShape {
    name: String,
    shape: pmb::Shape,
    kind: record::CoordinateKind,
    mode: Option<record::StructuralMode>,
}

fn shape(document: &Document, file: &PitchFile, grid: &MultiBlock) -> Result<NamedShape, Stop> {
    let m = &file.motion;
    let unit = |otherwise: [f64; 3]| -> Result<[f64; 3], Stop> {
        let d = m.direction.unwrap_or(otherwise);
        let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 && length.is_finite() {
            Ok(d.map(|x| x / length))
        } else {
            let message = format!("{d:?} is no direction");
            Err(document
                .error("motion.direction", message, "direction = [0, 1, 0]")
                .into())
        }
    };
    let axis = || -> Result<[f64; 3], Stop> {
        let help = "axis = [\"0.279 m\", \"0 m\", \"0 m\"], a point of the axis";
        let point = m.axis.ok_or_else(|| document.error("motion", "no axis", help))?;
        Ok(point.map(|x| x.0))
    };
    match m.kind {
        MotionKind::Pitch => {
            let (point, axis) = (axis()?, unit([0.0, 1.0, 0.0])?);
            Ok(NamedShape {
                name: "pitch".to_owned(),
                shape: pmb::Shape::Rotation { point, axis },
                kind: record::CoordinateKind::Pitch {
                    axis_point_m: point,
                    axis_direction: axis,
                },
                mode: None,
            })
        }
        MotionKind::Plunge => {
            let direction = unit([0.0, 0.0, 1.0])?;
            Ok(NamedShape {
                name: "plunge".to_owned(),
                shape: pmb::Shape::Translation { direction },
                kind: record::CoordinateKind::Plunge { direction },
                mode: None,
            })
        }
        MotionKind::Mode => mode(document, file, grid),
        MotionKind::Control => control(document, file, grid, axis()?, unit([0.0, 1.0, 0.0])?),
    }
}

fn mode(document: &Document, file: &PitchFile, grid: &MultiBlock) -> Result<NamedShape, Stop> {
    let Some(table) = &file.modes else {
        let help = "add [modes] with structure = \"structure.toml\", or with file and frequencies";
        return Err(document.error("", "motion of a mode, but no [modes]", help).into());
    };
    let modes = modes::from_table(document, table)?.modes;
    let number = file.motion.mode.unwrap_or(1);
    if number == 0 || number > modes.count() {
        let message = format!("mode {number}: there are {}", modes.count());
        return Err(document.error("motion.mode", message, "modes count from 1").into());
    }
    let mut deformation = deformation::of_modes(grid, &modes, number)?;
    let Some(field) = deformation.fields.pop() else {
        return Err(document
            .error("motion.mode", "no such mode", "modes count from 1")
            .into());
    };
    Ok(NamedShape {
        name: format!("mode {number}"),
        shape: pmb::Shape::Field(field),
        kind: record::CoordinateKind::Mode,
        mode: Some(record::StructuralMode {
            number: u32::try_from(number).unwrap_or(u32::MAX),
            omega_rad_s: modes.omega_rad_s[number - 1],
            generalized_mass_kg: modes.generalized_mass[number - 1],
            damping_ratio: 0.0,
        }),
    })
}

/// A flap: what lies behind the hinge between two span stations turns about it; at the ends the motion fades out, at the hinge the
/// wall bends. Linear in the angle.
fn control(
    document: &Document,
    file: &PitchFile,
    grid: &MultiBlock,
    point: [f64; 3],
    axis: [f64; 3],
) -> Result<NamedShape, Stop> {
    let m = &file.motion;
    let Some([from, to]) = m.span.map(|s| s.map(|x| x.0)) else {
        let help = "span = [\"0.3 m\", \"0.6 m\"], from and to along y";
        return Err(document
            .error("motion", "a control surface needs its span", help)
            .into());
    };
    if to.is_nan() || from.is_nan() || to <= from {
        let message = format!("from {from} m to {to} m: needed two different stations in order");
        return Err(document
            .error("motion.span", message, "span = [\"0.3 m\", \"0.6 m\"]")
            .into());
    }
    let blend = m.blend.map_or(0.1 * (to - from), |b| b.0).max(0.0);
    let (origin, hinge) = (Vector3::from(point), Vector3::from(axis));
    // Aft of the hinge, in the plane of stream and hinge.
    let aft = Vector3::x() - hinge * hinge.x;
    let fade = |y: f64| -> f64 {
        let outside = (from - y).max(y - to);
        if outside <= 0.0 {
            1.0
        } else if outside >= blend {
            0.0
        } else {
            let s = 1.0 - outside / blend;
            s * s * (3.0 - 2.0 * s)
        }
    };
    let mut deformation = deformation::of_shape(grid, |p| {
        let arm = p - origin;
        if arm.dot(&aft) > 0.0 {
            hinge.cross(&arm) * fade(p.y)
        } else {
            Vector3::zeros()
        }
    })?;
    let Some(field) = deformation.fields.pop() else {
        return Err(document
            .error("motion", "no wall to move", "check the grid's patches")
            .into());
    };
    Ok(NamedShape {
        name: "control".to_owned(),
        shape: pmb::Shape::Field(field),
        kind: record::CoordinateKind::Control {
            axis_point_m: point,
            axis_direction: axis,
        },
        mode: None,
    })
}
