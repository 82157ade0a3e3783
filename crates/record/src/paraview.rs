//! A recording as a ParaView series: one .vtp (surface) for each step and a .pvd that gives each its instant. Arrays are
//! raw bytes appended to the XML.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::RecordError;
use crate::recording::Recording;
use crate::setup::Setup;
use crate::step::Step;

/// Writes `path` (a .pvd) and beside it a folder of its stem with the surface at every step: where the wall is then, Cp,
/// patch number and side. Returns the files.
///
/// # Errors
/// [`RecordError::Io`].
pub fn write(path: &Path, recording: &Recording) -> Result<Vec<PathBuf>, RecordError> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = path.with_file_name(&stem);
    let put = |path: PathBuf, bytes: &[u8]| {
        fs::write(&path, bytes)
            .map_err(|source| RecordError::Io {
                path: path.display().to_string(),
                source,
            })
            .map(|()| path)
    };
    fs::create_dir_all(&folder).map_err(|source| RecordError::Io {
        path: folder.display().to_string(),
        source,
    })?;
    let mut index = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    let escaped = stem.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let mut files = Vec::new();
    for step in &recording.steps {
        let name = format!("{:06}.vtp", step.number);
        let _ = writeln!(
            index,
            "<DataSet timestep=\"{:?}\" part=\"0\" file=\"{escaped}/{name}\"/>",
            step.time_s
        );
        files.push(put(folder.join(name), &surface(&recording.setup, step))?);
    }
    index.push_str("</Collection>\n</VTKFile>\n");
    files.push(put(path.to_path_buf(), index.as_bytes())?);
    Ok(files)
}

/// Arrays one after another, each with its length in front.
#[derive(Default)]
struct Appended {
    /// Where the arrays are said to be.
    xml: String,
    bytes: Vec<u8>,
}

impl Appended {
    fn array(&mut self, kind: &str, name: &str, components: usize, bytes: impl Iterator<Item = [u8; 4]>) {
        let _ = writeln!(
            self.xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" \
             offset=\"{}\"/>",
            self.bytes.len()
        );
        let start = self.bytes.len();
        self.bytes.extend_from_slice(&[0; 8]);
        self.bytes.extend(bytes.flatten());
        let length = (self.bytes.len() - start - 8) as u64;
        self.bytes[start..start + 8].copy_from_slice(&length.to_le_bytes());
    }
    fn xml(&mut self, text: &str) {
        self.xml.push_str(text);
    }
}

/// The bytes of a .vtp file.
fn surface(setup: &Setup, step: &Step) -> Vec<u8> {
    let patches = &setup.surface.patches;
    let nodes = step.nodes_m(setup);
    let mut first = 0;
    let mut corners: Vec<u32> = Vec::new();
    for patch in patches {
        corners.extend(patch.faces.iter().flatten().map(|n| n + first));
        first += patch.nodes_m.len() as u32;
    }
    let faces = setup.surface.face_count();
    let mut out = Appended::default();
    out.xml("<CellData Scalars=\"Cp\">\n");
    let cp = step.pressures.iter().flatten();
    out.array("Float32", "Cp", 1, cp.map(|v| (*v as f32).to_le_bytes()));
    let patch = patches
        .iter()
        .enumerate()
        .flat_map(|(n, p)| vec![n as i32; p.faces.len()]);
    out.array("Int32", "patch", 1, patch.map(i32::to_le_bytes));
    let upper = patches.iter().flat_map(|p| &p.upper);
    out.array("Int32", "upper", 1, upper.map(|u| i32::from(*u).to_le_bytes()));
    out.xml("</CellData>\n<Points>\n");
    let points = nodes.iter().flatten().flatten();
    out.array("Float32", "points", 3, points.map(|v| (*v as f32).to_le_bytes()));
    out.xml("</Points>\n<Polys>\n");
    out.array("UInt32", "connectivity", 1, corners.iter().map(|n| n.to_le_bytes()));
    out.array(
        "UInt32",
        "offsets",
        1,
        (1..=faces as u32).map(|n| (4 * n).to_le_bytes()),
    );
    out.xml("</Polys>\n");
    let mut file = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"{faces}\">\n{}</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_",
        first, out.xml
    )
    .into_bytes();
    file.extend_from_slice(&out.bytes);
    file.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
    file
}
