//! `pmb mesh convert IN OUT`: a grid in another kind of file.

use super::target::check_new;
use super::words;
use crate::assemble::grid;
use crate::exit::{Done, Stop};
use dip_grid::file;
use dip_grid::plot3d::{Encoding, Layout};
use std::path::PathBuf;

/// Options of `pmb mesh convert`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The grid: Plot3D of any layout, CGNS (.cgns), or a recipe (.toml)
    from: PathBuf,
    /// The file to write: .vtm for ParaView, .cgns for CGNS, anything else is Plot3D with a .bc.toml and a .nmf beside it
    to: PathBuf,
    /// Boundary conditions of IN (.toml or .nmf; default: the .bc.toml or .nmf beside it)
    #[arg(long, value_name = "FILE")]
    boundary_conditions: Option<PathBuf>,
    /// How Plot3D numbers are stored
    #[arg(long, value_enum, default_value_t = Storage::Records)]
    encoding: Storage,
    /// Most significant byte first
    #[arg(long)]
    big_endian: bool,
    /// Record markers of 8 bytes
    #[arg(long)]
    long_markers: bool,
    /// Single precision
    #[arg(long)]
    single: bool,
    /// Write over an older file
    #[arg(long)]
    force: bool,
    /// Say nothing on stderr but warnings (the reasons of exit code 3) and errors
    #[arg(short, long)]
    quiet: bool,
}

/// How Plot3D numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Storage {
    /// Fortran records ("unformatted")
    Records,
    /// Bytes without records
    Stream,
    /// Text ("formatted")
    Text,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    words(args.quiet)?;
    let wrong = |option: &str, with: &str| {
        let message = format!("{option} goes with {with} only");
        Err(Stop::input(message, "see `pmb mesh convert --help`"))
    };
    if args.long_markers && args.encoding != Storage::Records {
        return wrong("--long-markers", "--encoding records");
    }
    if args.encoding == Storage::Text && (args.big_endian || args.single) {
        return wrong("--big-endian or --single", "--encoding records or stream");
    }
    check_new(&args.to, args.force)?;
    let loaded = grid::read(&args.from, args.boundary_conditions.as_deref())?;
    let big_endian = args.big_endian;
    let layout = Layout {
        encoding: match args.encoding {
            Storage::Records => Encoding::Records {
                big_endian,
                marker: if args.long_markers { 8 } else { 4 },
            },
            Storage::Stream => Encoding::Stream { big_endian },
            Storage::Text => Encoding::Ascii,
        },
        double: !args.single,
        ..Layout::default()
    };
    let notes = file::save(&args.to, &loaded.grid, layout).map_err(|e| grid::explain(&e))?;
    for note in notes {
        tracing::info!("{note}");
    }
    let (blocks, cells) = (loaded.grid.blocks.len(), loaded.grid.cell_count());
    tracing::info!("{blocks} blocks, {cells} cells in {}", args.to.display());
    Ok(Done::Clean)
}
