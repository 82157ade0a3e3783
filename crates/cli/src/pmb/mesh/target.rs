//! Where a grid goes: a folder of its own with a summary, or the file that the user names.

use crate::exit::Stop;
use crate::options::Common;
use crate::output::{RunFolder, SUMMARY};
use crate::stamp::Stamp;
use dip_grid::cgns;
use std::path::{Path, PathBuf};

/// Kinds of files that look like grid files but are none that can be written.
const NO_GRIDS: [&str; 8] = ["toml", "nmf", "vts", "vtu", "svg", "json", "csv", "su2"];

/// Where a grid and what belongs to it go.
#[derive(Debug)]
pub struct Target {
    /// The grid file.
    pub grid: PathBuf,
    /// The run's own folder, if it has one.
    folder: Option<RunFolder>,
}

impl Target {
    /// `--out` with an extension names the grid file; else it, or its default, names a folder.
    ///
    /// # Errors
    /// An older grid or run of other inputs without `--force`, a kind of file that cannot be written.
    pub fn open(recipe: &Path, common: &Common, stamp: &Stamp) -> Result<Self, Stop> {
        match &common.out {
            Some(file) if file.extension().is_some() && !file.is_dir() => {
                check_new(file, common.force)?;
                Ok(Self {
                    grid: file.clone(),
                    folder: None,
                })
            }
            _ => {
                let folder = RunFolder::open(&common.folder(recipe), stamp, common.force)?;
                let stem = recipe
                    .file_stem()
                    .map_or_else(|| "grid".into(), |s| s.to_string_lossy().into_owned());
                Ok(Self {
                    grid: folder.path().join(format!("{stem}.xyz")),
                    folder: Some(folder),
                })
            }
        }
    }

    /// Name of the grid for titles.
    pub fn title(&self) -> String {
        self.grid
            .file_stem()
            .map_or_else(|| "grid".into(), |s| s.to_string_lossy().into_owned())
    }

    /// A file beside the grid: its name without extension, then `ending`.
    pub fn beside(&self, ending: &str) -> PathBuf {
        self.grid.with_file_name(format!("{}{ending}", self.title()))
    }

    /// Writes a file beside the grid.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, ending: &str, content: &[u8]) -> Result<PathBuf, Stop> {
        let path = self.beside(ending);
        std::fs::write(&path, content).map_err(|e| Self::failed(&path, &e))?;
        Ok(path)
    }

    /// Writes the summary, last of all: in a folder it marks a finished run.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write_summary(&self, json: &str) -> Result<PathBuf, Stop> {
        match &self.folder {
            Some(folder) => folder.write(SUMMARY, json.as_bytes()),
            None => self.write("-summary.json", json.as_bytes()),
        }
    }

    /// A file that could not be written.
    pub fn failed(path: &Path, error: &std::io::Error) -> Stop {
        Stop::failed(
            format!("{}: cannot write: {error}", path.display()),
            "check the disk's space and the folder's rights",
        )
    }
}

/// A grid file may be written here: its kind is known, nothing is written over without `force`, its folder is there.
///
/// # Errors
/// Where one of these does not hold.
pub fn check_new(file: &Path, force: bool) -> Result<(), Stop> {
    let extension = file
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    if NO_GRIDS.contains(&extension.as_str()) {
        return Err(Stop::input(
            format!("{}: grids cannot be written as .{extension}", file.display()),
            "use .xyz, .p3d, .grd or .x for Plot3D, .cgns for CGNS, .vtm for ParaView",
        ));
    }
    if cgns::is_named_so(file) && !cgns::IS_BUILT {
        return Err(Stop::input(
            format!("{}: this program was built without CGNS", file.display()),
            "build it with `--features cgns` (docs/grids.md), or use .xyz for Plot3D",
        ));
    }
    if file.exists() && !force {
        return Err(Stop::input(
            format!("{} is there already", file.display()),
            "give another name, or write over it with --force",
        ));
    }
    if let Some(folder) = file.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| Target::failed(folder, &e))?;
    }
    Ok(())
}
