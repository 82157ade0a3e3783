//! What a check found, for `summary.json` and `--json`.

use crate::exit::Done;
use dip_grid::MultiBlock;
use dip_grid::quality::{CellPlace, Report};
use serde::Serialize;

/// A check's report. Lengths in metres, volumes in cubic metres.
#[derive(Debug, Serialize)]
pub struct Quality {
    blocks: usize,
    cells: usize,
    nodes: usize,
    two_dimensional: bool,
    volume_m3: f64,
    /// Smallest, mean and largest height of the cells on walls.
    wall_cell_height_m: Option<[f64; 3]>,
    figures: Vec<Figure>,
    findings: Vec<Finding>,
}

#[derive(Debug, Serialize)]
struct Figure {
    name: &'static str,
    mean: f64,
    /// Worst first.
    worst: Vec<Place>,
}

#[derive(Debug, Serialize)]
struct Place {
    value: f64,
    block: usize,
    block_name: String,
    ijk: [usize; 3],
    centre_m: [f64; 3],
}

#[derive(Debug, Serialize)]
struct Finding {
    /// The grid cannot be used so.
    fatal: bool,
    text: String,
}

impl Quality {
    /// The report on a grid.
    pub fn new(grid: &MultiBlock, report: &Report) -> Self {
        let place = |p: &CellPlace| Place {
            value: p.value,
            block: p.block,
            block_name: grid.blocks.get(p.block).map(|b| b.name.clone()).unwrap_or_default(),
            ijk: p.ijk,
            centre_m: p.centre,
        };
        Self {
            blocks: report.blocks,
            cells: report.cells,
            nodes: report.nodes,
            two_dimensional: grid.is_two_dimensional(),
            volume_m3: report.volume,
            wall_cell_height_m: report.wall_spacing,
            figures: report
                .figures
                .iter()
                .map(|f| Figure {
                    name: f.name,
                    mean: f.mean,
                    worst: f.worst.iter().map(place).collect(),
                })
                .collect(),
            findings: report
                .findings
                .iter()
                .map(|f| Finding {
                    fatal: f.fatal,
                    text: f.text.clone(),
                })
                .collect(),
        }
    }
}

/// Exit code 3 where a user must look; the findings on stderr where stdout is JSON, for the report has them.
pub fn outcome(report: &Report, json: bool) -> Done {
    if report.is_good() {
        return Done::Clean;
    }
    for finding in report.findings.iter().filter(|_| json) {
        tracing::warn!("{}", finding.text);
    }
    Done::LookAt
}
