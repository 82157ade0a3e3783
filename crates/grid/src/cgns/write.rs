//! From blocks and topology to a CGNS tree.

use std::collections::HashSet;
use std::path::Path;

use super::CgnsError;
use super::hdf5_write;
use super::node::{Data, Node, Precision, natural};
use super::periodic;
use super::terms;
use crate::topology::{Interface, MultiBlock, Patch};

/// Longest name of a node (SIDS).
const LONGEST: usize = 32;
/// Version of the standard that the nodes follow.
const VERSION: f64 = 3.4;

/// Writes a grid as a CGNS file of the kind HDF5: double precision, one zone a block, all interfaces from both sides, one
/// `BC_t` a patch with a family of its name.
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, grid: &MultiBlock) -> Result<(), CgnsError> {
    std::fs::write(path, encode(grid)).map_err(|source| CgnsError::Io {
        path: path.to_owned(),
        source,
    })
}

/// The bytes of [`write()`].
#[must_use]
pub fn encode(grid: &MultiBlock) -> Vec<u8> {
    let names = zone_names(grid);
    let whole = |values: Vec<i64>| Data::Integers(vec![values.len()], values);
    let mut base = Node::new("Base", "CGNSBase_t", whole(vec![3, 3]));
    for (n, block) in grid.blocks.iter().enumerate() {
        let (nodes, cells) = (block.nodes(), block.cells());
        let sizes = nodes.into_iter().chain(cells).map(|v| v as i64).chain([0; 3]).collect();
        let mut coordinates = Node::new("GridCoordinates", "GridCoordinates_t", Data::None);
        for (name, values) in [
            ("CoordinateX", &block.x),
            ("CoordinateY", &block.y),
            ("CoordinateZ", &block.z),
        ] {
            let data = Data::Reals(nodes.to_vec(), values.clone(), Precision::Double);
            coordinates.children.push(Node::new(name, "DataArray_t", data));
        }
        let mut zone = Node::new(&names[n], "Zone_t", Data::Integers(vec![3, 3], sizes))
            .with(Node::new("ZoneType", "ZoneType_t", Data::Text("Structured".into())))
            .with(coordinates);
        let joined = connectivity(grid, n, &names);
        if !joined.children.is_empty() {
            zone.children.push(joined);
        }
        let conditions = conditions(grid, n);
        if !conditions.children.is_empty() {
            zone.children.push(conditions);
        }
        base.children.push(zone);
    }
    families(grid, &mut base);
    let version = Data::Reals(vec![1], vec![VERSION], Precision::Single);
    let root = Node::new("HDF5 MotherNode", "Root Node of HDF5 File", Data::None)
        .with(Node::new("CGNSLibraryVersion", "CGNSLibraryVersion_t", version))
        .with(base);
    hdf5_write::encode(&root)
}

/// Names of the zones: those of the blocks if they can be so, sort as the blocks stand and are no patch's (families stand beside
/// zones), else numbers.
fn zone_names(grid: &MultiBlock) -> Vec<String> {
    let usable =
        |s: &str| !s.is_empty() && s.len() <= LONGEST && s.trim() == s && s.is_ascii() && !s.contains('/') && s != ".";
    let sorted = grid
        .blocks
        .windows(2)
        .all(|w| natural(&w[0].name, &w[1].name) == std::cmp::Ordering::Less);
    let of_patch = |s: &str| grid.topology.patches.iter().any(|p| node_name(&p.name) == s);
    if sorted && grid.blocks.iter().all(|b| usable(&b.name) && !of_patch(&b.name)) {
        return grid.blocks.iter().map(|b| b.name.clone()).collect();
    }
    (1..=grid.blocks.len()).map(|n| format!("block {n}")).collect()
}

/// A name that a node can have.
fn node_name(name: &str) -> String {
    let fit: String = name
        .chars()
        .map(|c| {
            if c.is_ascii_graphic() && c != '/' || c == ' ' {
                c
            } else {
                '_'
            }
        })
        .take(LONGEST)
        .collect();
    let fit = fit.trim();
    if fit.is_empty() || fit == "." {
        "unnamed".into()
    } else {
        fit.into()
    }
}

/// `name`, with a number where it was taken already.
fn unique(taken: &mut HashSet<String>, name: &str) -> String {
    let mut out = name.to_owned();
    let mut n = 1;
    while !taken.insert(out.clone()) {
        n += 1;
        let end = format!(" {n}");
        out = name.chars().take(LONGEST - end.len()).collect::<String>() + &end;
    }
    out
}

fn index_range(name: &str, range: terms::Range) -> Node {
    Node::new(name, "IndexRange_t", Data::Integers(vec![3, 2], range.concat()))
}

fn connectivity(grid: &MultiBlock, n: usize, names: &[String]) -> Node {
    let mut out = Node::new("ZoneGridConnectivity", "ZoneGridConnectivity_t", Data::None);
    let both = grid.topology.interfaces.iter().flat_map(|i| [*i, i.reversed()]);
    for (count, interface) in both.filter(|i| i.a.block == n).enumerate() {
        let Interface {
            a,
            b,
            orientation,
            period,
        } = interface;
        let cells = |s: usize| grid.blocks[s].cells();
        let donor = Data::Text(names[b.block].clone());
        let transform = Data::Integers(vec![3], terms::transform(a.face, b.face, orientation).to_vec());
        let mut node = Node::new(&format!("interface {}", count + 1), "GridConnectivity1to1_t", donor)
            .with(Node::new("Transform", "\"int[IndexDimension]\"", transform))
            .with(index_range("PointRange", terms::range(&a, cells(a.block), [false; 2])))
            .with(index_range(
                "PointRangeDonor",
                terms::range(&b, cells(b.block), orientation.reverse),
            ));
        if let Some(period) = period {
            let Some(property) = periodic::write(period) else {
                // Without it, the file would say that the sides touch.
                continue;
            };
            node.children.push(property);
        }
        out.children.push(node);
    }
    out
}

fn conditions(grid: &MultiBlock, n: usize) -> Node {
    let mut out = Node::new("ZoneBC", "ZoneBC_t", Data::None);
    let mut taken = HashSet::new();
    for patch in grid.topology.patches.iter().filter(|p| p.block == n) {
        let name = unique(&mut taken, &node_name(&patch.name));
        let range = terms::range(&patch.side(), grid.blocks[n].cells(), [false; 2]);
        let bc_type = Data::Text(terms::bc_type(patch.condition).into());
        let node = Node::new(&name, "BC_t", bc_type)
            .with(index_range("PointRange", range))
            .with(Node::new("FamilyName", "FamilyName_t", Data::Text(patch.name.clone())));
        out.children.push(node);
    }
    out
}

/// One family for each name of patches, with their condition where they have the same.
fn families(grid: &MultiBlock, base: &mut Node) {
    let mut seen = HashSet::new();
    let mut taken: HashSet<String> = base.children.iter().map(|c| c.name.clone()).collect();
    let all: &[Patch] = &grid.topology.patches;
    for patch in all {
        if !seen.insert(&patch.name) {
            continue;
        }
        let name = node_name(&patch.name);
        if !taken.insert(name.clone()) {
            continue;
        }
        let mut family = Node::new(&name, "Family_t", Data::None);
        if all
            .iter()
            .all(|p| p.name != patch.name || p.condition == patch.condition)
        {
            let bc_type = Data::Text(terms::bc_type(patch.condition).into());
            family.children.push(Node::new("FamilyBC", "FamilyBC_t", bc_type));
        }
        base.children.push(family);
    }
}
