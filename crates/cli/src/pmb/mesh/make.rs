//! `pmb mesh RECIPE`: makes a grid, checks it and draws it.

use super::quality::{Quality, outcome};
use crate::assemble::grid;
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer, check_interrupt, watch_interrupts};
use crate::stamp::{Fingerprint, Stamp};
use dip_grid::{picture, quality};
use serde::Serialize;
use std::path::PathBuf;

/// Options of `pmb mesh RECIPE`.
#[derive(Debug, clap::Args)]
#[command(mut_arg("out", |a| a.short('o')), mut_arg("set", |a| a.hide(true)))]
pub struct Args {
    /// The recipe (.toml)
    #[arg(required = true)]
    recipe: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary {
    command: &'static str,
    stamp: Stamp,
    stop_reason: &'static str,
    mesh_hash: String,
    #[serde(flatten)]
    quality: Quality,
    files: Vec<String>,
    stages: Vec<(String, Seconds)>,
    total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let Some(recipe) = &args.recipe else {
        return Err(Stop::input("no recipe", "give one: pmb mesh RECIPE.toml"));
    };
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
    let loaded = grid::read(recipe)?;
    stage("make", &timer);
    tracing::info!("{} cells in {:.2} s", loaded.grid.cell_count(), timer.seconds().wall_s);
    let mut fingerprint = Fingerprint::new();
    fingerprint.file(recipe.clone()).text(&loaded.hash);
    let stamp = fingerprint.stamp();
    let folder = RunFolder::open(&args.common.folder(recipe), &stamp, args.common.force)?;
    check_interrupt("nothing is written")?;

    let timer = Timer::start();
    let report = quality::check(&loaded.grid);
    stage("check", &timer);

    let timer = Timer::start();
    let stem = recipe
        .file_stem()
        .map_or_else(|| "grid".into(), |s| s.to_string_lossy().into_owned());
    let mut files = vec!["quality.txt".to_owned()];
    folder.write("quality.txt", report.to_string().as_bytes())?;
    for picture in picture::overview(&loaded.grid, &stem) {
        let name = format!("{stem}-{}.svg", picture.name);
        folder.write(&name, picture.svg.as_bytes())?;
        files.push(name);
    }
    stage("write", &timer);

    let summary = Summary {
        command: "pmb mesh",
        stamp,
        stop_reason: "done",
        mesh_hash: loaded.hash,
        quality: Quality::new(&loaded.grid, &report),
        files,
        stages,
        total: total.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&report.to_string());
        tracing::info!("results in {}", folder.path().display());
    }
    Ok(outcome(&report))
}
