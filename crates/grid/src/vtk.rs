//! ParaView files: a .vtm that names one .vts (structured grid) a block, arrays as raw bytes appended to the XML.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;

use crate::quality::Report;
use crate::topology::MultiBlock;

/// Where the values of a field stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// In cells.
    Cells,
    /// At nodes.
    Nodes,
}

/// A field on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name.
    pub name: String,
    /// Where its values stand.
    pub on: On,
    /// 1 for a scalar, 3 for a vector.
    pub components: usize,
    /// Values `[block][component + components * cell or node]`.
    pub values: Vec<Vec<f64>>,
}

/// Writes `path` (a .vtm) and beside it a folder of its stem with one .vts a block.
/// # Errors
/// If a file cannot be written, or a field does not have a value for every cell or node.
pub fn write(path: &Path, grid: &MultiBlock, fields: &[Field]) -> io::Result<()> {
    for field in fields {
        for (n, block) in grid.blocks.iter().enumerate() {
            let count = if field.on == On::Cells {
                block.cell_count()
            } else {
                block.node_count()
            };
            let got = field.values.get(n).map_or(0, Vec::len);
            if got != count * field.components {
                let text = format!(
                    "field {}: block {n} needs {} values, got {got}",
                    field.name,
                    count * field.components
                );
                return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
            }
        }
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = path.with_file_name(&stem);
    std::fs::create_dir_all(&folder)?;
    let mut index = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\">\n<vtkMultiBlockDataSet>\n",
    );
    for (n, block) in grid.blocks.iter().enumerate() {
        let file = format!("{n}.vts");
        let name = escape(&block.name);
        let _ = writeln!(
            index,
            "<DataSet index=\"{n}\" name=\"{name}\" file=\"{}/{file}\"/>",
            escape(&stem)
        );
        let mut out = io::BufWriter::new(std::fs::File::create(folder.join(file))?);
        out.write_all(&structured(grid, n, fields))?;
        out.flush()?;
    }
    index.push_str("</vtkMultiBlockDataSet>\n</VTKFile>\n");
    std::fs::write(path, index)
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// The bytes of a .vts file.
fn structured(grid: &MultiBlock, n: usize, fields: &[Field]) -> Vec<u8> {
    let block = &grid.blocks[n];
    let extent = format!("0 {} 0 {} 0 {}", block.ni, block.nj, block.nk);
    let mut head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <StructuredGrid WholeExtent=\"{extent}\">\n<Piece Extent=\"{extent}\">\n"
    );
    let mut data: Vec<u8> = Vec::new();
    let mut append = |values: &mut dyn Iterator<Item = f64>| {
        let start = data.len();
        data.extend([0; 8]);
        for v in values {
            data.extend(v.to_le_bytes());
        }
        let length = (data.len() - start - 8) as u64;
        data[start..start + 8].copy_from_slice(&length.to_le_bytes());
        start
    };
    let array = |name: &str, components: usize, offset: usize| {
        format!(
            "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>\n",
            escape(name)
        )
    };
    let points = append(&mut (0..block.node_count()).flat_map(|m| [block.x[m], block.y[m], block.z[m]]));
    head.push_str(&format!("<Points>\n{}</Points>\n", array("Points", 3, points)));
    for (on, tag) in [(On::Cells, "CellData"), (On::Nodes, "PointData")] {
        let _ = writeln!(head, "<{tag}>");
        for field in fields.iter().filter(|f| f.on == on) {
            let offset = append(&mut field.values[n].iter().copied());
            head.push_str(&array(&field.name, field.components, offset));
        }
        let _ = writeln!(head, "</{tag}>");
    }
    head.push_str("</Piece>\n</StructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    let mut out = head.into_bytes();
    out.extend(data);
    out.extend(b"\n</AppendedData>\n</VTKFile>\n");
    out
}

/// Writes the worst cells of a quality report as a ParaView file of hexahedra (.vtu) with the figure and the cell's block,
/// i, j, k.
/// # Errors
/// If the file cannot be written.
pub fn write_worst(path: &Path, grid: &MultiBlock, report: &Report) -> io::Result<()> {
    let cells: Vec<_> = report
        .figures
        .iter()
        .enumerate()
        .flat_map(|(n, f)| f.worst.iter().map(move |place| (n, place)))
        .filter(|(_, place)| place.block < grid.blocks.len())
        .collect();
    let mut points = String::new();
    for (_, place) in &cells {
        let [i, j, k] = place.ijk;
        let c = grid.blocks[place.block].corners(i, j, k);
        for n in [0, 1, 3, 2, 4, 5, 7, 6] {
            let _ = writeln!(points, "{:e} {:e} {:e}", c[n][0], c[n][1], c[n][2]);
        }
    }
    let list = |value: &dyn Fn(usize) -> String| (0..cells.len()).map(value).collect::<Vec<_>>().join(" ");
    let corners = (0..8 * cells.len())
        .map(|n| n.to_string())
        .collect::<Vec<_>>()
        .join(" ");
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n\
         <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n{points}</DataArray>\n</Points>\n<Cells>\n",
        8 * cells.len(),
        cells.len()
    );
    let array = |kind: &str, name: &str, values: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>\n")
    };
    text += &array("Int64", "connectivity", &corners);
    text += &array("Int64", "offsets", &list(&|n| (8 * (n + 1)).to_string()));
    text += &array("UInt8", "types", &list(&|_| "12".into()));
    text += "</Cells>\n<CellData>\n";
    text += &array("Float64", "figure", &list(&|n| cells[n].0.to_string()));
    text += &array("Float64", "value", &list(&|n| format!("{:e}", cells[n].1.value)));
    text += &array("Float64", "block", &list(&|n| cells[n].1.block.to_string()));
    for (d, name) in ["i", "j", "k"].into_iter().enumerate() {
        text += &array("Float64", name, &list(&|n| cells[n].1.ijk[d].to_string()));
    }
    text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    std::fs::write(path, text)
}
