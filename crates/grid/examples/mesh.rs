//! Makes a grid from a recipe (or opens a Plot3D file), checks it, draws it and writes it:
//! `cargo run --release -p dip-grid --example mesh -- RECIPE-OR-GRID [-o FOLDER]`.
//!
//! Into the folder go the grid as Plot3D with its boundary files, as ParaView files (and CGNS with `--features cgns`), its
//! pictures, and its worst cells.
//! Ends with 0 if the grid is good, 3 if a user must look, 2 if something is wrong with the input.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use dip_grid::{MultiBlock, file, picture, plot3d, quality, vtk};

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(3),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<bool, Box<dyn std::error::Error>> {
    const USAGE: &str = "usage: mesh RECIPE-OR-GRID [-o FOLDER]";
    let mut args = std::env::args().skip(1);
    let path = PathBuf::from(args.next().ok_or(USAGE)?);
    let folder = match (args.next().as_deref(), args.next()) {
        (Some("-o"), Some(folder)) => Some(PathBuf::from(folder)),
        (None, _) => None,
        _ => return Err(USAGE.into()),
    };
    let start = Instant::now();
    let opened = file::open(&path, None)?;
    eprintln!("{:.2} s", start.elapsed().as_secs_f64());
    for note in &opened.notes {
        println!("{note}");
    }
    let report = quality::check(&opened.grid);
    print!("{report}");
    if let Some(folder) = folder {
        write(&folder, &path, &opened.grid, &report)?;
    }
    Ok(report.is_good())
}

fn write(
    folder: &Path,
    from: &Path,
    grid: &MultiBlock,
    report: &quality::Report,
) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let stem = from.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    for picture in picture::overview(grid, &stem) {
        std::fs::write(folder.join(format!("{stem}-{}.svg", picture.name)), picture.svg)?;
    }
    for note in file::save(&folder.join(format!("{stem}.xyz")), grid, plot3d::Layout::default())? {
        println!("{note}");
    }
    file::save(&folder.join(format!("{stem}.vtm")), grid, plot3d::Layout::default())?;
    if cfg!(feature = "cgns") {
        file::save(&folder.join(format!("{stem}.cgns")), grid, plot3d::Layout::default())?;
    }
    vtk::write_worst(&folder.join(format!("{stem}-worst.vtu")), grid, report)?;
    Ok(())
}
