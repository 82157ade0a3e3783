//! `pmb mesh RECIPE`: makes a grid, checks it, writes and draws it.

use super::quality::{Quality, outcome};
use super::target::Target;
use crate::assemble::grid;
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output;
use crate::progress::{Seconds, Timer, check_interrupt, watch_interrupts};
use crate::stamp::{Fingerprint, Stamp};
use dip_grid::plot3d::Layout;
use dip_grid::{file, picture, quality, vtk};
use serde::Serialize;
use std::path::PathBuf;

/// Options of `pmb mesh RECIPE`.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("out", |a| a.short('o').value_name("OUT").help("A grid file (.xyz, .cgns, .vtm, ...), or a folder (default: runs/<recipe's folder>-<recipe>)")),
    mut_arg("set", |a| a.hide(true))
)]
pub struct Args {
    /// The recipe (.toml)
    #[arg(required = true)]
    recipe: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// What the summary holds.
#[derive(Debug, Serialize)]
struct Summary {
    command: &'static str,
    stamp: Stamp,
    stop_reason: &'static str,
    mesh_hash: String,
    #[serde(flatten)]
    quality: Quality,
    grid: PathBuf,
    pictures: Vec<PathBuf>,
    stages: Vec<(String, Seconds)>,
    total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let Some(recipe) = &args.recipe else {
        return Err(Stop::input("no recipe", "give one: pmb mesh RECIPE.toml"));
    };
    if recipe.extension().is_none_or(|e| e != "toml") {
        return Err(Stop::input(
            format!("{} is no recipe: needed a .toml file", recipe.display()),
            "`pmb mesh check FILE` looks at a grid, `pmb mesh convert IN OUT` converts one",
        ));
    }
    if !args.common.set.is_empty() {
        return Err(Stop::input(
            "--set does not go with a recipe",
            "write a recipe with `extends = \"other.toml\"` and the keys that differ",
        ));
    }
    watch_interrupts();
    let total = Timer::start();
    let mut stages = Vec::new();
    let mut stage = |name: &str, timer: &Timer| stages.push((name.to_owned(), timer.seconds()));

    let timer = Timer::start();
    let loaded = grid::read(recipe, None)?;
    stage("make", &timer);
    tracing::info!("{} cells in {:.2} s", loaded.grid.cell_count(), timer.seconds().wall_s);
    let mut fingerprint = Fingerprint::new();
    fingerprint.file(recipe.clone()).text(&loaded.hash);
    let stamp = fingerprint.stamp();
    let target = Target::open(recipe, &args.common, &stamp)?;
    check_interrupt("nothing is written")?;

    let timer = Timer::start();
    let report = quality::check(&loaded.grid);
    stage("check", &timer);

    let timer = Timer::start();
    let notes = file::save(&target.grid, &loaded.grid, Layout::default()).map_err(|e| grid::explain(&e))?;
    for note in notes {
        tracing::info!("{note}");
    }
    target.write("-quality.txt", report.to_string().as_bytes())?;
    let worst = target.beside("-worst.vtu");
    vtk::write_worst(&worst, &loaded.grid, &report).map_err(|e| Target::failed(&worst, &e))?;
    let mut pictures = Vec::new();
    for picture in picture::overview(&loaded.grid, &target.title()) {
        pictures.push(target.write(&format!("-{}.svg", picture.name), picture.svg.as_bytes())?);
    }
    stage("write", &timer);

    let summary = Summary {
        command: "pmb mesh",
        stamp,
        stop_reason: "done",
        mesh_hash: loaded.hash,
        quality: Quality::new(&loaded.grid, &report),
        grid: target.grid.clone(),
        pictures,
        stages,
        total: total.seconds(),
    };
    target.write_summary(&output::json(&summary)?)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&report.to_string());
        tracing::info!("grid in {}, pictures beside it", target.grid.display());
    }
    Ok(outcome(&report, args.common.json))
}
