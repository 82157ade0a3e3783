//! Tables of modes as comma-separated text.
//!
//! Two layouts, told apart by their header:
//! - wide: `node,x,y[,z],phi1,phi2,...`; `phi1` is the displacement along z of mode 1, `phi1_tx` to `phi1_rz`
//!   are its components along and about the basic axes;
//! - long: `mode_zone,node,x,y,z,dx,dy,dz[,rx,ry,rz]`, one line a mode and node.
//!
//! Coordinates may say their unit (`x_in`, `x_ft`, `x_mm`, `x_m`); results are in metres. Lines that begin with `#`
//! are comments, but `# freq_hz: ...`, `# omega_rad_s: ...` and `# generalized_mass_kg: ...` give one
//! value a mode. Displacements are kept as they are: they belong to the generalized mass.

use std::collections::HashMap;
use std::fmt::Write;

use nalgebra::{Matrix3, Vector3};

use crate::dof::DOFS_PER_NODE;
use crate::error::TableError;
use crate::modes::{ModeNode, Modes};

/// What a table does not say itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableOptions {
    /// Metres per unit of the coordinates; `None`: what the header says, or metres.
    pub length_unit_m: Option<f64>,
    /// Circular frequency of each mode, rad/s; empty: from the table's comments.
    pub omega_rad_s: Vec<f64>,
    /// Generalized mass of each mode, kg; empty: from the table's comments, or 1 kg.
    pub generalized_mass_kg: Vec<f64>,
}

/// Ends of component names, in the order of the degrees of freedom.
const COMPONENTS: [&str; DOFS_PER_NODE] = ["tx", "ty", "tz", "rx", "ry", "rz"];

struct Header {
    line: usize,
    names: Vec<String>,
    column: HashMap<String, usize>,
}

impl Header {
    fn new(line: usize, text: &str) -> Self {
        let names: Vec<String> = text.split(',').map(|n| n.trim().to_ascii_lowercase()).collect();
        let column = names.iter().cloned().enumerate().map(|(i, n)| (n, i)).collect();
        Self { line, names, column }
    }

    /// Column of a coordinate and the unit its name says, metres.
    fn coordinate(&self, name: &str) -> Option<(usize, Option<f64>)> {
        let units = [
            ("", None),
            ("_m", Some(1.0)),
            ("_mm", Some(1e-3)),
            ("_in", Some(0.0254)),
            ("_ft", Some(0.3048)),
        ];
        units
            .iter()
            .find_map(|(end, unit)| Some((*self.column.get(&format!("{name}{end}"))?, *unit)))
    }

    fn need<T>(&self, found: Option<T>, column: &str, needed: &'static str) -> Result<T, TableError> {
        found.ok_or_else(|| TableError::NoColumn {
            line: self.line,
            column: column.to_owned(),
            needed,
        })
    }
}

struct Line<'a> {
    number: usize,
    fields: Vec<&'a str>,
}

impl Line<'_> {
    fn value(&self, column: usize, name: &str) -> Result<f64, TableError> {
        let text = self.fields.get(column).copied().unwrap_or("");
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| TableError::Line {
                line: self.number,
                needed: format!("a finite number in column {} ({name})", column + 1),
                got: text.to_owned(),
            })
    }

    fn integer(&self, column: usize, name: &str) -> Result<u32, TableError> {
        let text = self.fields.get(column).copied().unwrap_or("");
        text.trim().parse::<u32>().map_err(|_| TableError::Line {
            line: self.number,
            needed: format!("a whole number in column {} ({name})", column + 1),
            got: text.to_owned(),
        })
    }
}

impl Modes {
    /// Reads a table of modes; lengths become metres.
    ///
    /// # Errors
    /// [`TableError`] naming the line and what was needed.
    pub fn from_csv(text: &str, options: &TableOptions) -> Result<Self, TableError> {
        let mut comments = HashMap::new();
        let mut header = None;
        let mut lines = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let line = line.trim();
            if let Some(comment) = line.strip_prefix('#') {
                if let Some((key, values)) = comment.split_once(':') {
                    comments.insert(key.trim().to_ascii_lowercase(), (i + 1, values.trim().to_owned()));
                }
            } else if line.is_empty() {
            } else if header.is_none() {
                header = Some(Header::new(i + 1, line));
            } else {
                lines.push(Line {
                    number: i + 1,
                    fields: line.split(',').collect(),
                });
            }
        }
        let header = header.ok_or(TableError::NoHeader)?;
        let (nodes, shapes) = if header.column.contains_key("mode_zone") {
            read_long(&header, &lines, options)?
        } else {
            read_wide(&header, &lines, options)?
        };
        let count = shapes.len();
        let listed = |key: &str| match comments.get(key) {
            Some((line, text)) => numbers(*line, text).map(Some),
            None => Ok(None),
        };
        let omega = if !options.omega_rad_s.is_empty() {
            options.omega_rad_s.clone()
        } else if let Some(omega) = listed("omega_rad_s")? {
            omega
        } else {
            let freq = listed("freq_hz")?.unwrap_or_default();
            freq.iter().map(|f| f * std::f64::consts::TAU).collect()
        };
        let mass = if !options.generalized_mass_kg.is_empty() {
            options.generalized_mass_kg.clone()
        } else {
            listed("generalized_mass_kg")?.unwrap_or_else(|| vec![1.0; count])
        };
        for (name, values) in [
            ("the list of frequencies", &omega),
            ("the list of generalized masses", &mass),
        ] {
            if values.len() != count {
                return Err(TableError::Count {
                    name,
                    got: values.len(),
                    needed: count,
                });
            }
        }
        Ok(Self {
            nodes,
            shapes,
            omega_rad_s: omega,
            generalized_mass: mass,
            residual: Vec::new(),
        })
    }

    /// Writes the table in the wide layout with all components in basic axes, lengths in metres.
    pub fn to_csv(&self) -> String {
        let list = |values: &[f64]| values.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join(",");
        let mut out = format!(
            "# omega_rad_s: {}\n# generalized_mass_kg: {}\nnode,x_m,y_m,z_m",
            list(&self.omega_rad_s),
            list(&self.generalized_mass)
        );
        for mode in 1..=self.count() {
            for c in COMPONENTS {
                let _ = write!(out, ",phi{mode}_{c}");
            }
        }
        out.push('\n');
        for (n, node) in self.nodes.iter().enumerate() {
            let p = &node.position;
            let _ = write!(out, "{},{:e},{:e},{:e}", node.id, p.x, p.y, p.z);
            for mode in 0..self.count() {
                let (u, r) = self.motion(mode, n);
                for v in u.iter().chain(r.iter()) {
                    let _ = write!(out, ",{v:e}");
                }
            }
            out.push('\n');
        }
        out
    }
}

fn numbers(line: usize, text: &str) -> Result<Vec<f64>, TableError> {
    text.split([',', ' ', ';'])
        .filter(|t| !t.is_empty())
        .map(|t| {
            t.parse::<f64>()
                .ok()
                .filter(|v| v.is_finite() && *v >= 0.0)
                .ok_or_else(|| TableError::Line {
                    line,
                    needed: "a list of finite numbers of at least zero".to_owned(),
                    got: t.to_owned(),
                })
        })
        .collect()
}

type Table = (Vec<ModeNode>, Vec<Vec<[f64; DOFS_PER_NODE]>>);

/// Columns of node number and coordinates, and metres per unit of each.
struct Place {
    node: usize,
    axes: [Option<(usize, f64)>; 3],
}

impl Place {
    fn new(header: &Header, options: &TableOptions) -> Result<Self, TableError> {
        const NEEDED: &str = "node, x, y and optionally z";
        let node = header.need(header.column.get("node").copied(), "node", NEEDED)?;
        let unit = |c: (usize, Option<f64>)| (c.0, options.length_unit_m.or(c.1).unwrap_or(1.0));
        let x = header.need(header.coordinate("x"), "x", NEEDED)?;
        let y = header.need(header.coordinate("y"), "y", NEEDED)?;
        Ok(Self {
            node,
            axes: [Some(unit(x)), Some(unit(y)), header.coordinate("z").map(unit)],
        })
    }

    fn read(&self, line: &Line) -> Result<ModeNode, TableError> {
        let mut position = Vector3::zeros();
        for (axis, column) in self.axes.iter().enumerate() {
            if let Some((column, unit)) = column {
                position[axis] = unit * line.value(*column, ["x", "y", "z"][axis])?;
            }
        }
        Ok(ModeNode {
            id: line.integer(self.node, "node")?,
            position,
            frame: Matrix3::identity(),
        })
    }
}

/// `phi3` or `phi3_ry`: mode from 1, component.
fn shape_column(name: &str) -> Option<(usize, usize)> {
    let rest = name.strip_prefix("phi")?;
    let (number, component) = rest.split_once('_').unwrap_or((rest, "tz"));
    let mode = number.parse::<usize>().ok().filter(|&m| m > 0)?;
    Some((mode, COMPONENTS.iter().position(|c| *c == component)?))
}

fn read_wide(header: &Header, lines: &[Line], options: &TableOptions) -> Result<Table, TableError> {
    let place = Place::new(header, options)?;
    let columns: Vec<(usize, usize, usize)> = header
        .names
        .iter()
        .enumerate()
        .filter_map(|(c, name)| shape_column(name).map(|(m, d)| (c, m, d)))
        .collect();
    let mut modes: Vec<usize> = columns.iter().map(|c| c.1).collect();
    modes.sort_unstable();
    modes.dedup();
    // Modes are numbered without gaps, so that place and number agree.
    if let Some(missing) = (1..=modes.len().max(1)).find(|m| !modes.contains(m)) {
        return header.need(None, &format!("phi{missing}"), "phi1, phi2, ... without gaps");
    }
    let mut nodes = Vec::with_capacity(lines.len());
    let mut shapes = vec![vec![[0.0; DOFS_PER_NODE]; lines.len()]; modes.len()];
    for (n, line) in lines.iter().enumerate() {
        nodes.push(place.read(line)?);
        for &(column, mode, dof) in &columns {
            shapes[mode - 1][n][dof] = line.value(column, &header.names[column])?;
        }
    }
    Ok((nodes, shapes))
}

fn read_long(header: &Header, lines: &[Line], options: &TableOptions) -> Result<Table, TableError> {
    let place = Place::new(header, options)?;
    let zone = header.need(header.column.get("mode_zone").copied(), "mode_zone", "mode_zone")?;
    let names = ["dx", "dy", "dz", "rx", "ry", "rz"];
    let columns: Vec<(usize, usize)> = names
        .iter()
        .enumerate()
        .filter_map(|(d, n)| header.column.get(*n).map(|c| (*c, d)))
        .collect();
    header.need(header.column.get("dz"), "dz", "dx, dy, dz")?;
    let mut nodes: Vec<ModeNode> = Vec::new();
    let mut shapes: Vec<Vec<[f64; DOFS_PER_NODE]>> = Vec::new();
    for line in lines {
        let mode = line.integer(zone, "mode_zone")? as usize;
        if mode == shapes.len() + 1 {
            shapes.push(Vec::new());
        } else if mode == 0 || mode != shapes.len() {
            return Err(TableError::Line {
                line: line.number,
                needed: format!(
                    "mode {} or {}, as modes follow each other from 1",
                    shapes.len(),
                    shapes.len() + 1
                ),
                got: mode.to_string(),
            });
        }
        let node = place.read(line)?;
        let shape = &mut shapes[mode - 1];
        if mode == 1 {
            nodes.push(node);
        } else if nodes.get(shape.len()).is_none_or(|n| n.id != node.id) {
            return Err(TableError::Line {
                line: line.number,
                needed: nodes.get(shape.len()).map_or_else(
                    || format!("no more than the {} nodes of mode 1", nodes.len()),
                    |n| format!("node {}, as in mode 1", n.id),
                ),
                got: node.id.to_string(),
            });
        }
        let mut values = [0.0; DOFS_PER_NODE];
        for &(column, dof) in &columns {
            values[dof] = line.value(column, names[dof])?;
        }
        shape.push(values);
    }
    if let Some((m, shape)) = shapes.iter().enumerate().find(|(_, s)| s.len() != nodes.len()) {
        return Err(TableError::Ragged {
            mode: m + 1,
            got: shape.len(),
            needed: nodes.len(),
        });
    }
    Ok((nodes, shapes))
}
