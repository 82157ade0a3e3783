//! Makes every shipped recipe, checks it, and writes `docs/validation/grids/`: a table of quality figures, and pictures.
//! `cargo run --release -p dip-grid --example validate_grids`

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use dip_grid::quality::{self, names};
use dip_grid::{picture, recipe, wall_distance};

/// Recipes with the pictures that the page shows.
const SHOWN: [(&str, &[&str]); 5] = [
    ("agard445_oo_coarse", &["surface", "section", "tip", "symmetry-plane"]),
    ("agard445_ch_coarse", &["section", "nose", "symmetry-plane"]),
    ("naca0012_c", &["section", "nose"]),
    ("naca0012_o", &["section", "tail"]),
    ("naca0012_blunt", &["tail"]),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let out = root.join("docs/validation/grids");
    std::fs::create_dir_all(&out)?;
    let mut recipes: Vec<PathBuf> = std::fs::read_dir(root.join("meshes"))?
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    recipes.sort();
    let mut page = String::from(
        "# Quality of the shipped grids\n\nMade by `cargo run --release -p dip-grid --example validate_grids`, which makes every recipe in `meshes/` and checks every cell.\n\n\
         - *nodes*: of all blocks; those on interfaces count for each block.\n\
         - *volume*: smallest cell volume in m^3 (two-dimensional grids are one chord or length across); all must be above zero.\n\
         - *Jacobian*: smallest corner Jacobian over the product of the edges; 1 is a box. It is zero at the ends of a wing's\n  tip and of sheets, where a corner of 180 degrees is part of the topology.\n\
         - *skew*: largest departure from 90 degrees of the lines through a cell; on swept wings 45 degrees are the planform's.\n\
         - *stretch*: largest ratio of neighbouring cells' thickness.\n\
         - *closure*: largest sum of a cell's area vectors over the sum of its areas.\n\
         - *wall*: least and mean height of the wall's cells.\n\n\
         | recipe | blocks | cells | nodes | volume | Jacobian | skew | stretch | closure | wall | seconds | verdict |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for path in &recipes {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let start = Instant::now();
        let grid = recipe::make(path)?;
        let seconds = start.elapsed().as_secs_f64();
        let report = quality::check(&grid);
        let worst = |name: &str| {
            report
                .figure(name)
                .and_then(|f| f.worst.first())
                .map_or(f64::NAN, |p| p.value)
        };
        let wall = report
            .wall_spacing
            .map_or("-".into(), |[least, mean, _]| format!("{least:.2e} / {mean:.2e} m"));
        let verdict = if report.is_good() {
            "good".into()
        } else {
            format!("{} findings", report.findings.len())
        };
        writeln!(
            page,
            "| {stem} | {} | {} | {} | {:.2e} | {:.3} | {:.1} | {:.2} | {:.0e} | {wall} | {seconds:.1} | {verdict} |",
            report.blocks,
            report.cells,
            report.nodes,
            worst(names::VOLUME),
            worst(names::JACOBIAN),
            worst(names::SKEWNESS),
            worst(names::STRETCHING),
            worst(names::CLOSURE),
        )?;
        println!("{stem}: {verdict}, {seconds:.1} s");
        if let Some((_, views)) = SHOWN.iter().find(|(name, _)| *name == stem) {
            for shown in picture::overview(&grid, &stem) {
                if views.contains(&shown.name.as_str()) {
                    std::fs::write(out.join(format!("{stem}-{}.svg", shown.name)), shown.svg)?;
                }
            }
        }
    }
    page.push_str("\nSeconds are wall time of making, splitting included, on two threads of a shared machine; they are not part of the check.\n");
    page.push_str("\n## Wall distance\n\n| recipe | cells | seconds |\n|---|---|---|\n");
    for stem in ["agard445_ch_coarse", "agard445_ch_medium"] {
        let grid = recipe::make(&root.join("meshes").join(format!("{stem}.toml")))?;
        let start = Instant::now();
        let distances = wall_distance::of_cells(&grid, dip_grid::Condition::is_wall);
        let count: usize = distances.iter().map(Vec::len).sum();
        writeln!(page, "| {stem} | {count} | {:.2} |", start.elapsed().as_secs_f64())?;
    }
    page.push_str(
        "\nThat the distances are those of a search over all triangles is a test (`wall_distance_is_exact_and_equals_brute_force`).\n\n## Pictures\n",
    );
    for (stem, views) in SHOWN {
        for view in views {
            write!(page, "\n![{stem}, {view}]({stem}-{view}.svg)\n")?;
        }
    }
    std::fs::write(out.join("README.md"), page)?;
    Ok(())
}
