//! Makes a grid from a recipe, checks it and draws it:
//! `cargo run --release -p dip-grid --example mesh -- RECIPE [-o FOLDER]`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use dip_grid::{picture, quality, recipe};

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
    let mut args = std::env::args().skip(1);
    let path = PathBuf::from(args.next().ok_or("usage: mesh RECIPE [-o FOLDER]")?);
    let folder = match (args.next().as_deref(), args.next()) {
        (Some("-o"), Some(folder)) => Some(PathBuf::from(folder)),
        (None, _) => None,
        _ => return Err("usage: mesh RECIPE [-o FOLDER]".into()),
    };
    let start = Instant::now();
    let grid = recipe::make(&path)?;
    eprintln!("made in {:.2} s", start.elapsed().as_secs_f64());
    let report = quality::check(&grid);
    print!("{report}");
    if let Some(folder) = folder {
        write(&folder, &path, &grid)?;
    }
    Ok(report.is_good())
}

fn write(folder: &Path, recipe: &Path, grid: &dip_grid::MultiBlock) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let stem = recipe.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    for picture in picture::overview(grid, &stem) {
        std::fs::write(folder.join(format!("{stem}-{}.svg", picture.name)), picture.svg)?;
    }
    Ok(())
}
