//! Makes every shipped recipe, checks it, and writes `docs/validation/grids/`: a table of quality figures, and pictures.
//! `cargo run --release -p dip-grid --example validate_grids`

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use dip_grid::picture::{self, Camera, Sheet};
use dip_grid::quality::{self, Report, names};
use dip_grid::recipe::{self, Recipe, SmoothingStart, SmoothingTable};
use dip_grid::{Block, MultiBlock, coarsen, metrics, vector, wall_distance};

/// Recipes with the pictures that the page shows.
const SHOWN: [(&str, &[&str]); 8] = [
    ("agard445_oo_coarse", &["surface", "section", "tip", "symmetry-plane"]),
    ("agard445_oo_smoothed", &["nose", "tip"]),
    ("agard445_ch_coarse", &["section", "nose", "symmetry-plane"]),
    ("agard445_ch_smoothed", &["nose", "tail"]),
    ("agard445_section", &["section", "nose", "tail"]),
    ("naca0012_c", &["section", "nose"]),
    ("naca0012_o", &["section", "tail"]),
    ("naca0012_blunt", &["tail"]),
];

fn main() -> Result<(), Box<dyn Error>> {
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
         - *wall*: least and mean height of the wall's cells.\n\
         - *angle*: largest and mean angle between the line off the wall and the wall's normal. Planes y = const round a swept wing\n  lean by its sweep at the nose; away from it lines are normal to the wall.\n\n\
         | recipe | blocks | cells | nodes | volume | Jacobian | skew | stretch | closure | wall | angle, deg | seconds | verdict |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for path in &recipes {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let start = Instant::now();
        let grid = recipe::make(path)?;
        let seconds = start.elapsed().as_secs_f64();
        let report = quality::check(&grid);
        let worst = |name: &str| worst(&report, name);
        let angle = report.figure(names::WALL_ANGLE).map_or("-".into(), |f| {
            format!("{:.1} / {:.2}", worst(names::WALL_ANGLE), f.mean)
        });
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
            "| {stem} | {} | {} | {} | {:.2e} | {:.3} | {:.1} | {:.2} | {:.0e} | {wall} | {angle} | {seconds:.1} | {verdict} |",
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
    families(&root, &mut page)?;
    smoothing(&root, &out, &mut page)?;
    page.push_str(BROKEN);
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

fn worst(report: &Report, name: &str) -> f64 {
    report
        .figure(name)
        .and_then(|f| f.worst.first())
        .map_or(f64::NAN, |p| p.value)
}

/// Are the coarser levels of the shipped families the finer ones' points?
fn families(root: &Path, page: &mut String) -> Result<(), Box<dyn Error>> {
    page.push_str(
        "\n## Levels\n\nEvery second point of the finer level, compared with the level as its recipe makes it (as one block).\n\n\
         | finer | nodes | coarser | nodes | points that differ in any bit |\n|---|---|---|---|---|\n",
    );
    for family in ["oo", "ch"] {
        let names = ["", "_medium", "_coarse", "_coarsest"].map(|level| format!("agard445_{family}{level}"));
        let mut finer: Option<MultiBlock> = None;
        for (n, name) in names.iter().enumerate() {
            let grid = one_block(root, name)?.make()?;
            if let Some(finer) = finer {
                let kept = coarsen::coarsen(&finer)?;
                let differ: usize = kept.blocks.iter().zip(&grid.blocks).map(|(a, b)| differing(a, b)).sum();
                writeln!(
                    page,
                    "| {} | {} | {name} | {} | {differ} |",
                    names[n - 1],
                    finer.node_count(),
                    grid.node_count()
                )?;
            }
            finer = Some(grid);
        }
    }
    Ok(())
}

fn one_block(root: &Path, name: &str) -> Result<Recipe, Box<dyn Error>> {
    let mut recipe = recipe::read(&root.join("meshes").join(format!("{name}.toml")))?;
    recipe.blocks = None;
    Ok(recipe)
}

fn differing(a: &Block, b: &Block) -> usize {
    if a.cells() != b.cells() {
        return a.node_count().max(b.node_count());
    }
    let bits = |block: &Block, n: usize| [block.x[n], block.y[n], block.z[n]].map(f64::to_bits);
    (0..a.node_count()).filter(|&n| bits(a, n) != bits(b, n)).count()
}

/// What smoothing does to viscous grids, from the map and from transfinite interpolation.
fn smoothing(root: &Path, out: &Path, page: &mut String) -> Result<(), Box<dyn Error>> {
    page.push_str(
        "\n## Smoothing\n\nViscous grids, y+ = 1 or below, with and without a `[smoothing]` table:\n\n\
         - *skew*: largest and mean;\n\
         - *angle of lines*: between the first step off a node of the wall and the normal of the four faces about it, without the\n  wall's edges (symmetry plane, \
         trailing edge, tip): median, 90 %, 99 %, largest;\n\
         - *angle of cells*: mean of the check's figure, edges of the wall included;\n\
         - *step*: largest relative change of any first step against the map's.\n\n\
         | recipe | inside | sweeps | skew | angle of lines, deg | angle of cells, deg | step | seconds |\n|---|---|---|---|---|---|---|---|\n",
    );
    let of = |start, sweeps| {
        Some(SmoothingTable {
            start,
            sweeps: Some(sweeps),
        })
    };
    for name in [
        "agard445_section",
        "naca0012_viscous",
        "rae2822_c",
        "agard445_ch_smoothed",
        "agard445_oo_smoothed",
    ] {
        let mut recipe = one_block(root, name)?;
        let cases = [
            ("map", None),
            ("map, smoothed", of(SmoothingStart::Map, 300)),
            ("transfinite", of(SmoothingStart::Transfinite, 0)),
            ("transfinite, smoothed", of(SmoothingStart::Transfinite, 100)),
            ("transfinite, smoothed", of(SmoothingStart::Transfinite, 300)),
        ];
        let mut map: Option<MultiBlock> = None;
        for (inside, table) in cases {
            // Surfaces of O-O grids are smoothed from the map alone.
            if name.contains("_oo_") && inside.starts_with("transfinite") {
                continue;
            }
            recipe.smoothing = table;
            let sweeps = table.and_then(|t| t.sweeps).unwrap_or(0);
            let start = Instant::now();
            let grid = match recipe.make() {
                Ok(grid) => grid,
                Err(e) => {
                    // Without the path, which is this machine's.
                    let text = e.to_string();
                    let what = text.split_once(".toml: ").map_or(text.as_str(), |(_, what)| what);
                    writeln!(page, "| {name} | {inside} | {sweeps} | refused: {what} | | | | |")?;
                    continue;
                }
            };
            let seconds = start.elapsed().as_secs_f64();
            let report = quality::check(&grid);
            let mean = |figure: &str| report.figure(figure).map_or(f64::NAN, |f| f.mean);
            let off = map
                .as_ref()
                .map_or(0.0, |map| step_off(&map.blocks[0], &grid.blocks[0]));
            let [median, most, nearly, worst_line] = lean(&grid);
            writeln!(
                page,
                "| {name} | {inside} | {sweeps} | {:.1} / {:.1} | {median:.2} / {most:.2} / {nearly:.2} / {worst_line:.1} | {:.2} | {off:.0e} | {seconds:.1} |",
                worst(&report, names::SKEWNESS),
                mean(names::SKEWNESS),
                mean(names::WALL_ANGLE),
            )?;
            println!("{name}, {inside}: {seconds:.1} s");
            let keep = |file: &str, svg: String| std::fs::write(out.join(file), svg);
            if name == "agard445_section" && inside == "transfinite" {
                for shown in picture::overview(&grid, "AGARD 445.6 section, transfinite interpolation alone") {
                    if shown.name == "nose" {
                        keep("transfinite-nose.svg", shown.svg)?;
                    }
                }
            }
            if name == "agard445_oo_smoothed" {
                let stem = if table.is_some() { "smoothed" } else { "map" };
                keep(&format!("leading-edge-{stem}.svg"), leading_edge(&grid, inside))?;
            }
            map.get_or_insert(grid);
        }
    }
    page.push_str(
        "\nThe conformal map is the solution of Laplace's equations in the plane of a section: smoothing cannot better it there but at\n\
         kinks. Transfinite interpolation becomes usable by smoothing; `agard445_section` is made so. On swept wings smoothing turns the\n\
         lines into the wall's normal, which planes y = const miss by the sweep at the nose. What is left is the symmetry plane, whose\n\
         lines stay in it, and the closure of the tip.\n\n\
         ![AGARD 445.6 section, transfinite interpolation alone](transfinite-nose.svg)\n\n\
         A line off the leading edge of the O-O grid at half span, from above: from the map, and smoothed.\n\n\
         ![Line off the leading edge, from the map](leading-edge-map.svg)\n\n\
         ![Line off the leading edge, smoothed](leading-edge-smoothed.svg)\n",
    );
    Ok(())
}

/// Median, 90 %, 99 % and largest angle (deg) between first steps and the normal of the four wall faces about their feet.
fn lean(grid: &MultiBlock) -> [f64; 4] {
    let block = &grid.blocks[0];
    let wall = grid.topology.patches.iter().find(|p| p.condition.is_wall());
    let Some(window) = wall.map(|p| p.window) else {
        return [f64::NAN; 4];
    };
    // Along the span: without symmetry plane and the last tenth, where the tip closes; across a plane: both sides.
    let span = window.hi[1];
    let ks = if span == 1 { 0..1 } else { 1..span * 9 / 10 };
    let mut angles = Vec::new();
    for k in ks {
        for i in window.lo[0] + 1..window.hi[0] {
            let point = |di: usize, dk: usize| {
                let k = if span == 1 { dk.min(1) } else { k + dk - 1 };
                block.point(i + di - 1, 0, k)
            };
            let mut normal = [0.0; 3];
            for (a, c) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let corners = [point(a, c), point(a + 1, c), point(a + 1, c + 1), point(a, c + 1)];
                let [p, q, r, s] = corners;
                normal = vector::add(normal, metrics::face_area(p, q, r, s));
            }
            let step = vector::sub(block.point(i, 1, k), block.point(i, 0, k));
            let cos = vector::dot(vector::unit(step), vector::unit(normal)).abs();
            angles.push(cos.min(1.0).acos().to_degrees());
        }
    }
    angles.sort_by(f64::total_cmp);
    let last = angles.len().saturating_sub(1);
    [0.5, 0.9, 0.99, 1.0].map(|share| angles.get((share * last as f64) as usize).copied().unwrap_or(f64::NAN))
}

/// The surface of lines off the leading edge at half span, from above.
fn leading_edge(grid: &MultiBlock, inside: &str) -> String {
    let block = &grid.blocks[0];
    let (i, k) = (block.ni / 2, block.nk / 2);
    let [x, y, _] = block.point(i, 0, k);
    let half = 1.5e-3;
    let window = [y - half, y + half, -x - 0.2 * half, -x + 1.2 * half];
    let sheets = [Sheet::whole(0, block, 0, i), Sheet::whole(0, block, 1, 0)];
    let title = format!("AGARD 445.6, O-O at y+ = 1, leading edge at half span, 3 mm wide: {inside}");
    picture::draw(grid, &title, Camera::TOP, window, &sheets, &[])
}

/// Largest relative difference of the first steps off j = 0.
fn step_off(a: &Block, b: &Block) -> f64 {
    let step = |block: &Block, i: usize, k: usize| vector::distance(block.point(i, 0, k), block.point(i, 1, k));
    let lines = (0..=a.nk).flat_map(|k| (0..=a.ni).map(move |i| (i, k)));
    lines
        .map(|(i, k)| (step(b, i, k) / step(a, i, k) - 1.0).abs())
        .fold(0.0, f64::max)
}

/// How broken input was searched for, by hand: the search is not part of this program.
const BROKEN: &str = "
## Broken input

`crates/grid/tests/fuzz.rs` (Plot3D grids and solutions of every layout, files of other programs, neutral maps, boundary files,
pairs of grid and map as a user opens them, ordinates), `tests/cgns.rs` and `tests/recipes.rs` break files that are right: bytes
changed or cut off; words replaced by 24 odd ones; lines swapped, removed or doubled. Nothing may panic, and what still reads must go through
interfaces, check and both boundary files. A long search is `DIP_FUZZ_CASES=100000 cargo test --release -p dip-grid --features cgns --test
fuzz --test cgns --test recipes damaged random`. Done so far: 60 CPU minutes in all, 34 of them with an earlier form of these tests, whose one finding (a
block one node thick along i) is a test in `tests/files.rs`; 26 CPU minutes (more than 10 million cases) with the present form, the readers of OVERFLOW's
solutions and of records of single arrays among them, without a finding.
";
