//! A CGNS tree as HDF5 holds it: groups with a name, a label and data.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use hdf5_pure::{DType, Dataset, File, Group};

/// How deep trees and chains of links may be.
const DEPTH: usize = 24;
/// Most nodes of a tree.
const MOST_NODES: usize = 1 << 20;
/// Deflate makes data at most 1032 times smaller (RFC 1951: 258 bytes from two bits).
const MOST_PACKED: u64 = 1032;

/// Labels of nodes that say something about a grid; others (solutions, histories) are passed over with all below them.
const LABELS: [&str; 22] = [
    "CGNSBase_t",
    "Zone_t",
    "ZoneType_t",
    "GridCoordinates_t",
    "DataArray_t",
    "Rind_t",
    "DimensionalUnits_t",
    "ZoneGridConnectivity_t",
    "GridConnectivity1to1_t",
    "GridConnectivity_t",
    "OversetHoles_t",
    "IndexRange_t",
    "IndexArray_t",
    "\"int[IndexDimension]\"",
    "GridConnectivityProperty_t",
    "Periodic_t",
    "ZoneBC_t",
    "BC_t",
    "GridLocation_t",
    "FamilyName_t",
    "Family_t",
    "FamilyBC_t",
];

/// Data of a node.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Data {
    /// Nothing.
    None,
    /// Characters.
    Text(String),
    /// Whole numbers; the shape as CGNS has it, first index fastest.
    Integers(Vec<usize>, Vec<i64>),
    /// Reals of 8 or 4 bytes; the shape as CGNS has it, first index fastest.
    Reals(Vec<usize>, Vec<f64>, Precision),
}

/// Width of reals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    /// `R4`.
    Single,
    /// `R8`.
    Double,
}

/// A node and everything below it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) name: String,
    pub(super) label: String,
    pub(super) data: Data,
    pub(super) children: Vec<Node>,
}

impl Node {
    pub(super) fn new(name: &str, label: &str, data: Data) -> Self {
        Self {
            name: name.to_owned(),
            label: label.to_owned(),
            data,
            children: Vec::new(),
        }
    }

    pub(super) fn with(mut self, child: Self) -> Self {
        self.children.push(child);
        self
    }

    pub(super) fn labelled<'a>(&'a self, label: &'a str) -> impl Iterator<Item = &'a Self> {
        self.children.iter().filter(move |c| c.label == label)
    }

    pub(super) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|c| c.name == name)
    }

    /// The text of a node, without what pads it.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.data {
            Data::Text(text) => Some(text.trim_matches(['\0', ' '])),
            _ => None,
        }
    }

    /// The whole numbers of a node.
    pub(super) fn integers(&self) -> Option<&[i64]> {
        match &self.data {
            Data::Integers(_, values) => Some(values),
            _ => None,
        }
    }

    /// The numbers of a node as reals.
    pub(super) fn reals(&self) -> Option<Vec<f64>> {
        match &self.data {
            Data::Reals(_, values, _) => Some(values.clone()),
            Data::Integers(_, values) => Some(values.iter().map(|&v| v as f64).collect()),
            _ => None,
        }
    }
}

/// Reads the tree of a file. `folder` is where files stand that it links to; without it such links are errors.
pub(super) fn read(bytes: Vec<u8>, folder: Option<&Path>) -> Result<Node, String> {
    const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
    if !bytes.starts_with(SIGNATURE) {
        return Err(if bytes.is_empty() {
            "the file is empty".into()
        } else if bytes.windows(3).take(64).any(|w| w == b"ADF") {
            "a CGNS file of the old ADF kind; turn it into HDF5 with `adf2hdf` of the CGNS tools".into()
        } else {
            "not a CGNS file: HDF5 is needed".into()
        });
    }
    let size = bytes.len() as u64;
    let file = File::from_bytes(bytes).map_err(|e| format!("not a readable HDF5 file: {e}"))?;
    let mut reader = Reader {
        files: vec![(PathBuf::new(), file, size)],
        folder: folder.map(Path::to_owned),
        nodes: 0,
    };
    let root = reader.files[0].1.root();
    let mut tree = Node::new("", "", Data::None);
    tree.children = reader.children(0, &root, "", DEPTH)?;
    Ok(tree)
}

struct Reader {
    /// The file itself and those it links to, with their sizes.
    files: Vec<(PathBuf, File, u64)>,
    folder: Option<PathBuf>,
    nodes: usize,
}

impl Reader {
    fn children(&mut self, file: usize, group: &Group, path: &str, depth: usize) -> Result<Vec<Node>, String> {
        let at = |e: hdf5_pure::Error| format!("{}: {e}", if path.is_empty() { "/" } else { path });
        let mut out = Vec::new();
        for (name, child) in group.iter_groups().map_err(at)? {
            let path = format!("{path}/{name}");
            if let Some(node) = self.node(file, &child, &name, &path, depth)? {
                out.push(node);
            }
        }
        out.sort_by(|a, b| natural(&a.name, &b.name));
        Ok(out)
    }

    /// A node with all that is below; `None` if it says nothing about a grid.
    fn node(
        &mut self,
        file: usize,
        group: &Group,
        name: &str,
        path: &str,
        depth: usize,
    ) -> Result<Option<Node>, String> {
        if depth == 0 {
            return Err(format!(
                "{path}: nodes are more than {DEPTH} deep, or links go in a circle"
            ));
        }
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            return Err(format!("more than {MOST_NODES} nodes"));
        }
        let at = |e: hdf5_pure::Error| format!("{path}: {e}");
        let attributes = group.attrs().map_err(at)?;
        let attribute = |key: &str| {
            attributes
                .get(key)
                .and_then(|v| v.as_str())
                .unwrap_or_default()
                .trim_matches(['\0', ' '])
        };
        if attribute("type") == "LK" {
            return self.linked(file, group, name, path, depth);
        }
        let label = attribute("label").to_owned();
        if !LABELS.contains(&label.as_str()) {
            return Ok(None);
        }
        let mut data = Data::None;
        for (name, dataset) in group.iter_datasets().map_err(at)? {
            if name == " data" {
                data = values(&dataset, self.files[file].2).map_err(|e| format!("{path}: {e}"))?;
            }
        }
        let mut node = Node::new(name, &label, data);
        node.children = self.children(file, group, path, depth - 1)?;
        Ok(Some(node))
    }

    /// The node that a link names: `" path"` in this file, or in the one that `" file"` names.
    fn linked(
        &mut self,
        file: usize,
        group: &Group,
        name: &str,
        path: &str,
        depth: usize,
    ) -> Result<Option<Node>, String> {
        let word = |key: &str| -> Result<Option<String>, String> {
            for (name, dataset) in group.iter_datasets().map_err(|e| format!("{path}: {e}"))? {
                if name == key
                    && let Data::Text(text) =
                        values(&dataset, self.files[file].2).map_err(|e| format!("{path}: {e}"))?
                {
                    return Ok(Some(text.trim_matches(['\0', ' ']).to_owned()).filter(|t| !t.is_empty()));
                }
            }
            Ok(None)
        };
        let target = word(" path")?.ok_or_else(|| format!("{path}: a link that names no path"))?;
        let other = match word(" file")? {
            None => file,
            Some(named) => self.other_file(path, &named)?,
        };
        let source = self.files[other].1.clone();
        let linked = source
            .group(&target)
            .map_err(|e| format!("{path}: links to {target}: {e}"))?;
        self.node(other, &linked, name, &target, depth - 1)
    }

    fn other_file(&mut self, path: &str, named: &str) -> Result<usize, String> {
        let Some(folder) = &self.folder else {
            return Err(format!("{path}: links to the file {named}, which is not at hand"));
        };
        let full = folder.join(named);
        if let Some(known) = self.files.iter().position(|(p, ..)| *p == full) {
            return Ok(known);
        }
        let fail = |e: &dyn std::fmt::Display| format!("{path}: links to {}: {e}", full.display());
        let bytes = std::fs::read(&full).map_err(|e| fail(&e))?;
        let size = bytes.len() as u64;
        let file = File::from_bytes(bytes).map_err(|e| fail(&e))?;
        self.files.push((full, file, size));
        Ok(self.files.len() - 1)
    }
}

/// The numbers or characters of a dataset in a file of `file_size` bytes.
fn values(dataset: &Dataset, file_size: u64) -> Result<Data, String> {
    let fail = |e: hdf5_pure::Error| e.to_string();
    let shape = dataset.shape().map_err(fail)?;
    let claimed = shape
        .iter()
        .try_fold(dataset.element_size().map_err(fail)?, |size, &n| size.checked_mul(n))
        .filter(|&size| size <= file_size.saturating_mul(if dataset.is_chunked() { MOST_PACKED } else { 1 }));
    if claimed.is_none() {
        return Err(format!(
            "its data of {shape:?} values do not fit into a file of {file_size} bytes"
        ));
    }
    let ours: Vec<usize> = shape.iter().rev().filter_map(|&n| usize::try_from(n).ok()).collect();
    Ok(match dataset.dtype().map_err(fail)? {
        DType::I8 | DType::U8 => {
            let bytes = dataset.read_raw().map_err(fail)?;
            Data::Text(String::from_utf8_lossy(&bytes).into_owned())
        }
        DType::String => Data::Text(dataset.read_string().map_err(fail)?.concat()),
        DType::I32 | DType::I64 | DType::U32 | DType::U64 => Data::Integers(ours, dataset.read_i64().map_err(fail)?),
        DType::F32 => Data::Reals(ours, dataset.read_f64().map_err(fail)?, Precision::Single),
        DType::F64 => Data::Reals(ours, dataset.read_f64().map_err(fail)?, Precision::Double),
        other => return Err(format!("its data are of the type {other}, which no CGNS node has")),
    })
}

/// Order of names in which numbers count as numbers: `zone 2` before `zone 10`.
pub(super) fn natural(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    loop {
        let (Some(x), Some(y)) = (a.first(), b.first()) else {
            return a.len().cmp(&b.len());
        };
        if x.is_ascii_digit() && y.is_ascii_digit() {
            let digits = |s: &[u8]| s.iter().take_while(|c| c.is_ascii_digit()).count();
            let ((m, rest_a), (n, rest_b)) = (a.split_at(digits(a)), b.split_at(digits(b)));
            let significant = |s: &'_ [u8]| s.iter().position(|&c| c != b'0').unwrap_or(s.len());
            let (m0, n0) = (&m[significant(m)..], &n[significant(n)..]);
            let order = m0
                .len()
                .cmp(&n0.len())
                .then_with(|| m0.cmp(n0))
                .then(m.len().cmp(&n.len()));
            if order != Ordering::Equal {
                return order;
            }
            (a, b) = (rest_a, rest_b);
        } else {
            if x != y {
                return x.cmp(y);
            }
            (a, b) = (&a[1..], &b[1..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::natural;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = vec!["zone 10", "zone 2", "a", "zone 02", "zone", "zone 2b"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["a", "zone", "zone 2", "zone 2b", "zone 02", "zone 10"]);
    }
}
