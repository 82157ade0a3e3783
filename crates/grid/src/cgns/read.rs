//! From a CGNS tree to blocks and topology.

use std::path::Path;

use super::CgnsError;
use super::conditions::patches;
use super::node::{self, Data, Node, Precision};
use super::periodic;
use super::terms::{self, Range};
use crate::block::Block;
use crate::topology::{Interface, MultiBlock};

/// A CGNS file's grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// Blocks with the interfaces and conditions that the file names. A two-dimensional zone stands in the plane (x, z), one
    /// cell across.
    pub grid: MultiBlock,
    /// True if any coordinates are 4-byte reals.
    pub single: bool,
    /// What a user should know: nodes that were passed over, units.
    pub notes: Vec<String>,
}

/// Reads the grid of a CGNS file; links to other files are followed.
/// # Errors
/// Names the node, what is wrong and what is needed.
pub fn read(path: &Path) -> Result<Read, CgnsError> {
    let bytes = std::fs::read(path).map_err(|source| CgnsError::Io {
        path: path.to_owned(),
        source,
    })?;
    tree(&path.to_string_lossy(), bytes, path.parent())
}

/// Reads the grid from the bytes of a CGNS file; `file` names it in messages.
/// # Errors
/// As [`read()`]; a link to another file is an error.
pub fn parse(file: &str, bytes: Vec<u8>) -> Result<Read, CgnsError> {
    tree(file, bytes, None)
}

fn tree(file: &str, bytes: Vec<u8>, folder: Option<&Path>) -> Result<Read, CgnsError> {
    node::read(bytes, folder)
        .and_then(|root| grid(&root))
        .map_err(|what| CgnsError::Content {
            file: file.to_owned(),
            what,
        })
}

/// A structured zone and what its block is called.
pub(super) struct Zone<'a> {
    pub(super) node: &'a Node,
    pub(super) dimensions: usize,
}

fn grid(root: &Node) -> Result<Read, String> {
    let mut bases = root.labelled("CGNSBase_t");
    let Some(base) = bases.next() else {
        return Err("it holds no CGNSBase_t: no CGNS grid".into());
    };
    let mut notes: Vec<String> = bases
        .map(|b| format!("base {} was passed over: the first one, {}, is read", b.name, base.name))
        .collect();
    let mut single = false;
    let mut grid = MultiBlock::default();
    let mut zones = Vec::new();
    for zone in base.labelled("Zone_t") {
        let kind = zone
            .labelled("ZoneType_t")
            .next()
            .and_then(Node::text)
            .unwrap_or("Structured");
        if kind != "Structured" {
            return Err(format!("zone {} is {kind}; structured zones are needed", zone.name));
        }
        let at = |what: String| format!("zone {}: {what}", zone.name);
        let (block, dimensions, precision) = block(zone).map_err(at)?;
        single |= precision == Precision::Single;
        grid.blocks.push(block);
        zones.push(Zone { node: zone, dimensions });
    }
    if zones.is_empty() {
        return Err(format!("base {} holds no zones", base.name));
    }
    let unit = base
        .labelled("DimensionalUnits_t")
        .next()
        .or_else(|| {
            let coordinates = zones.first()?.node.labelled("GridCoordinates_t").next()?;
            coordinates
                .labelled("DataArray_t")
                .find_map(|a| a.labelled("DimensionalUnits_t").next())
        })
        .and_then(Node::text)
        // Mass, length, time, ...: words of 32 characters.
        .and_then(|t| t.get(32..).map(|t| t.get(..32).unwrap_or(t).trim_matches(['\0', ' '])));
    if let Some(unit) = unit.filter(|u| !["Meter", "Null", "UserDefined", ""].contains(u)) {
        notes.push(format!("coordinates are in the unit {unit}; they are not scaled"));
    }
    for (n, zone) in zones.iter().enumerate() {
        interfaces(&mut grid, &zones, n, &mut notes).map_err(|what| format!("zone {}: {what}", zone.node.name))?;
    }
    for (n, zone) in zones.iter().enumerate() {
        patches(&mut grid, base, zone, n, &mut notes).map_err(|what| format!("zone {}: {what}", zone.node.name))?;
    }
    Ok(Read { grid, single, notes })
}

fn block(zone: &Node) -> Result<(Block, usize, Precision), String> {
    let sizes = zone.integers().unwrap_or_default();
    let dimensions = sizes.len() / 3;
    if !(2..=3).contains(&dimensions) || sizes.len() != 3 * dimensions {
        return Err(format!(
            "9 whole numbers are needed (6 in two dimensions), got {}",
            sizes.len()
        ));
    }
    let mut nodes = [1usize; 3];
    for d in 0..dimensions {
        nodes[d] = usize::try_from(sizes[d]).ok().filter(|&n| n >= 2).ok_or_else(|| {
            format!(
                "at least 2 nodes a direction are needed, got {:?}",
                &sizes[..dimensions]
            )
        })?;
    }
    let count = nodes
        .iter()
        .try_fold(1usize, |a, &n| a.checked_mul(n))
        .ok_or("its sizes cannot be counted")?;
    let Some(coordinates) = zone
        .child("GridCoordinates")
        .or_else(|| zone.labelled("GridCoordinates_t").next())
    else {
        return Err("it has no GridCoordinates_t".into());
    };
    let mut precision = Precision::Double;
    let mut array = |name: &str| -> Result<Option<Vec<f64>>, String> {
        let Some(array) = coordinates.child(name) else {
            return Ok(None);
        };
        let Data::Reals(shape, values, width) = &array.data else {
            return Err(format!("{name}: reals are needed"));
        };
        if *width == Precision::Single {
            precision = Precision::Single;
        }
        let values =
            without_rind(coordinates, &nodes[..dimensions], shape, values).map_err(|e| format!("{name}: {e}"))?;
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            return Err(format!(
                "{name} of node {at} (i fastest) is {}, not a coordinate",
                values[at]
            ));
        }
        debug_assert_eq!(values.len(), count);
        Ok(Some(values))
    };
    let (x, y, z) = (array("CoordinateX")?, array("CoordinateY")?, array("CoordinateZ")?);
    let cells = [nodes[0] - 1, nodes[1] - 1, nodes[2].max(2) - 1];
    let block = match (dimensions, x, y, z) {
        (3, Some(x), Some(y), Some(z)) => Block {
            name: zone.name.clone(),
            ni: cells[0],
            nj: cells[1],
            nk: cells[2],
            x,
            y,
            z,
        },
        (2, Some(x), Some(y), z) => {
            let flat = |v: &[f64]| v.iter().all(|&a| a == v[0]);
            let up = match z {
                Some(z) if !flat(&z) && flat(&y) => z,
                _ => y,
            };
            Block::across(&zone.name, [cells[0], cells[1]], &x, &up)
        }
        _ => {
            let found: Vec<&str> = coordinates.children.iter().map(|c| c.name.as_str()).collect();
            return Err(format!(
                "CoordinateX, CoordinateY{} are needed, found {found:?}",
                if dimensions == 3 { ", CoordinateZ" } else { "" }
            ));
        }
    };
    Ok((block, dimensions, precision))
}

/// An array's values without the planes of ghost nodes that `Rind_t` says it has.
fn without_rind(of: &Node, nodes: &[usize], shape: &[usize], values: &[f64]) -> Result<Vec<f64>, String> {
    let d = nodes.len();
    let rind = of
        .labelled("Rind_t")
        .next()
        .and_then(Node::integers)
        .unwrap_or_default();
    let mut planes = [[0usize; 2]; 3];
    if !rind.is_empty() {
        for (n, &v) in rind.iter().enumerate().take(2 * d) {
            planes[n / 2][n % 2] = usize::try_from(v).map_err(|_| format!("Rind_t says {rind:?}"))?;
        }
        if rind.len() != 2 * d {
            return Err(format!(
                "Rind_t: {} whole numbers are needed, got {}",
                2 * d,
                rind.len()
            ));
        }
    }
    let full: Option<Vec<usize>> = (0..d)
        .map(|n| nodes[n].checked_add(planes[n][0])?.checked_add(planes[n][1]))
        .collect();
    let fits = full.as_ref().is_some_and(|full| {
        let count = full.iter().try_fold(1usize, |a, &n| a.checked_mul(n));
        count == Some(values.len()) && (shape.len() != d || shape == full)
    });
    let (Some(full), true) = (full, fits) else {
        return Err(format!(
            "{shape:?} values do not fit a zone of {nodes:?} nodes{}",
            if rind.is_empty() {
                String::new()
            } else {
                format!(" with Rind_t {rind:?}")
            }
        ));
    };
    if rind.iter().all(|&v| v == 0) {
        return Ok(values.to_vec());
    }
    let size = |n: usize, of: &[usize]| of.get(n).copied().unwrap_or(1);
    let mut out = Vec::with_capacity(nodes.iter().product());
    for k in 0..size(2, nodes) {
        for j in 0..size(1, nodes) {
            let row = planes[0][0] + size(0, &full) * (j + planes[1][0] + size(1, &full) * (k + planes[2][0]));
            out.extend_from_slice(&values[row..row + nodes[0]]);
        }
    }
    Ok(out)
}

/// A range of a node, with the direction across added in two dimensions.
pub(super) fn range(node: &Node, dimensions: usize) -> Result<Range, String> {
    let values = node.integers().unwrap_or_default();
    if values.len() != 2 * dimensions {
        return Err(format!(
            "{}: {} whole numbers are needed, got {}",
            node.name,
            2 * dimensions,
            values.len()
        ));
    }
    let mut out = [[1; 3], [2; 3]];
    let (first, last) = values.split_at(dimensions);
    out[0][..dimensions].copy_from_slice(first);
    out[1][..dimensions].copy_from_slice(last);
    Ok(out)
}

fn interfaces(grid: &mut MultiBlock, zones: &[Zone], n: usize, notes: &mut Vec<String>) -> Result<(), String> {
    let zone = &zones[n];
    for connectivity in zone.node.labelled("ZoneGridConnectivity_t") {
        for other in &connectivity.children {
            match other.label.as_str() {
                "GridConnectivity1to1_t" => {}
                "GridConnectivity_t" | "OversetHoles_t" => {
                    notes.push(format!(
                        "zone {}: {} ({}) was passed over: only 1-to-1 connectivity is understood; nodes that coincide are found all the same",
                        zone.node.name, other.name, other.label
                    ));
                    continue;
                }
                _ => continue,
            }
            let at = |what: String| format!("{}: {what}", other.name);
            if let Some(interface) = interface(grid, zones, n, other, notes).map_err(at)? {
                let known = |i: &Interface| *i == interface || i.reversed() == interface;
                if !grid.topology.interfaces.iter().any(known) {
                    grid.topology.interfaces.push(interface);
                }
            }
        }
    }
    Ok(())
}

fn interface(
    grid: &MultiBlock,
    zones: &[Zone],
    n: usize,
    node: &Node,
    notes: &mut Vec<String>,
) -> Result<Option<Interface>, String> {
    let dimensions = zones[n].dimensions;
    // The donor may be named with its base: "Base/Zone".
    let named = node.text().unwrap_or_default();
    let donor = named.rsplit('/').next().unwrap_or_default();
    let Some(m) = zones.iter().position(|z| z.node.name == donor) else {
        notes.push(format!(
            "zone {}: {} joins a zone {named} that is not there; it was passed over",
            zones[n].node.name, node.name
        ));
        return Ok(None);
    };
    let part = |name: &str| node.child(name).ok_or_else(|| format!("{name} is needed"));
    let here = range(part("PointRange")?, dimensions)?;
    let there = range(part("PointRangeDonor")?, zones[m].dimensions)?;
    let a = terms::side(n, grid.blocks[n].cells(), here)?;
    let b = terms::side(m, grid.blocks[m].cells(), there)?;
    let mut transform = [1, 2, 3];
    if let Some(given) = node.child("Transform") {
        let values = given.integers().unwrap_or_default();
        if values.len() != dimensions {
            return Err(format!(
                "Transform: {dimensions} whole numbers are needed, got {}",
                values.len()
            ));
        }
        transform[..dimensions].copy_from_slice(values);
    }
    let (sa, sb) = (a.window.size(), b.window.size());
    let orientation = terms::orientation(a.face, b.face, transform)
        .filter(|o| o.size(sa) == sb)
        .ok_or_else(|| {
            format!(
                "Transform {:?} does not lead from {here:?} to {there:?} of zone {donor}",
                &transform[..dimensions]
            )
        })?;
    // Both ranges begin at the same node.
    for (d, to) in (0..3).map(|d| (d, (transform[d].unsigned_abs() - 1) as usize)) {
        let step = (here[1][d] - here[0][d]) * transform[d].signum();
        if step != there[1][to] - there[0][to] {
            return Err(format!(
                "PointRange {here:?} with Transform {:?} ends elsewhere than PointRangeDonor {there:?}",
                &transform[..dimensions]
            ));
        }
    }
    let mut interface = Interface {
        a,
        b,
        orientation,
        period: periodic::read(node, dimensions)?,
    };
    if let Some(period) = interface.period {
        let [p, q] = a.window.lo;
        let from = grid.blocks[n].point_at(grid.blocks[n].node_behind(a.face, p, q, 0));
        let [p, q] = interface.node_on_b(p, q);
        let to = grid.blocks[m].point_at(grid.blocks[m].node_behind(b.face, p, q, 0));
        interface.period = Some(periodic::sharpened(period, from, to));
    }
    Ok(Some(interface))
}
