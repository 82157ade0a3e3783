//! Broken input is an error and never a panic: files that are right but for a few bytes, words or lines.
//!
//! Each case is one broken file. `DIP_FUZZ_CASES=100000 cargo test --release -p dip-grid --test fuzz` searches longer; how long
//! it has been done in all stands in docs/validation/grids. CGNS files and recipes are broken in `cgns.rs` and `recipes.rs`.

use std::path::{Path, PathBuf};

use dip_grid::connect::{Options, fill_rest, find_interfaces};
use dip_grid::generate::BoxGrid;
use dip_grid::plot3d::{self, Encoding, Layout, Solution, SolutionBlock};
use dip_grid::{Condition, MultiBlock, boundary_file, file, nmf, quality, split};
use proptest::prelude::*;
use proptest::sample::Index;

fn layouts() -> Vec<Layout> {
    let mut encodings = vec![Encoding::Ascii];
    for big_endian in [false, true] {
        encodings.push(Encoding::Stream { big_endian });
        encodings.push(Encoding::Records { big_endian, marker: 4 });
        encodings.push(Encoding::Records { big_endian, marker: 8 });
    }
    let mut out = Vec::new();
    for encoding in encodings {
        for bits in 0..16 {
            let (double, multi, three_d, iblank) = (bits & 1 != 0, bits & 2 != 0, bits & 4 != 0, bits & 8 != 0);
            out.push(Layout {
                encoding,
                double: double || encoding == Encoding::Ascii,
                multi,
                three_d,
                iblank,
            });
        }
    }
    out
}

/// Two blocks that touch, for the files beside grids.
fn grid() -> MultiBlock {
    let mut grid = BoxGrid::new([-1.0, 0.0, 0.3], [2.0, 1.0, 1.7], [3, 2, 2])
        .wavy(0.04)
        .make();
    split::split_into(&mut grid, 2);
    grid
}

/// A solution that is right, in every layout.
fn solution(layout: Layout) -> Vec<u8> {
    let variables = if layout.three_d { 5 } else { 4 };
    let nodes = [3, 2, if layout.three_d { 2 } else { 1 }];
    let count: usize = nodes.iter().product();
    let block = SolutionBlock {
        nodes,
        reference: [0.75, 2.5, 6.5e6, 0.0],
        q: vec![vec![0.5; count]; variables],
    };
    let blocks = vec![block; if layout.multi { 2 } else { 1 }];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("q");
    let layout = Layout {
        iblank: false,
        ..layout
    };
    plot3d::write_solution(&path, &Solution { blocks, layout }).unwrap();
    std::fs::read(path).unwrap()
}

/// Files of other programs.
fn others() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/grids");
    let mut all: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e != "cgns" && e != "py" && e != "md"))
        .collect();
    all.sort();
    all.iter().map(|p| std::fs::read(p).unwrap()).collect()
}

/// A record of a Fortran program.
fn record(content: &[u8]) -> Vec<u8> {
    let mark = (content.len() as u32).to_le_bytes();
    [&mark, content, &mark].concat()
}

/// A solution of OVERFLOW, and a grid whose sizes are integers of eight bytes.
fn of_records() -> Vec<Vec<u8>> {
    let integers = |values: &[i32]| record(&values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>());
    let reference = record(&[vec![0; 56], vec![0; 4], vec![0; 64]].concat());
    let values = record(&[0.5f64.to_le_bytes(); 6 * 12].concat());
    let sizes = record(&[3i64, 2, 2].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>());
    let nodes = record(&(0..36).flat_map(|n| f64::from(n).to_le_bytes()).collect::<Vec<_>>());
    vec![
        [integers(&[1]), integers(&[3, 2, 2, 6, 0]), reference, values].concat(),
        [sizes, nodes].concat(),
    ]
}

/// Bytes of files that are right.
fn whole() -> Vec<Vec<u8>> {
    let grid = grid();
    let mut out = others();
    // As often as there are layouts of one encoding, so that they are met as often.
    for _ in 0..8 {
        out.extend(of_records());
    }
    for layout in layouts() {
        let blocks = if layout.multi {
            &grid.blocks[..]
        } else {
            &grid.blocks[..1]
        };
        let bytes = plot3d::encode(blocks, &[], layout).unwrap();
        out.push(bytes);
        out.push(solution(layout));
    }
    out
}

fn broken_bytes() -> impl Strategy<Value = Vec<u8>> {
    let all = whole();
    (
        any::<Index>(),
        // Sizes and markers stand at the start, so most changes do.
        proptest::collection::vec((any::<Index>(), any::<u8>(), any::<bool>()), 0..6),
        any::<Index>(),
        0..4,
    )
        .prop_map(move |(which, changes, end, cut)| {
            let mut bytes = all[which.index(all.len())].clone();
            for (at, value, early) in changes {
                let at = at.index(if early { bytes.len().min(64) } else { bytes.len() });
                bytes[at] = value;
            }
            if cut == 0 {
                bytes.truncate(end.index(bytes.len() + 1));
            }
            bytes
        })
}

/// What may stand in the place of a word.
const ODD: [&str; 24] = [
    "",
    "0",
    "1",
    "2",
    "3",
    "7",
    "-1",
    "-9223372036854775808",
    "18446744073709551615",
    "1e999",
    "nan",
    "-inf",
    "2*3",
    "0*1",
    "999999999999*0",
    "1.0D+400",
    "'wall'",
    "TRUE",
    "\"",
    "[",
    "]",
    "=",
    "#",
    "kmax",
];

/// Text with some of its words replaced, removed or doubled, and lines changed about.
fn broken(text: &str, words: &[(Index, usize)], lines: &[(Index, Index)], gone: Option<Index>) -> String {
    // Words with what stands between them: splitting at the ends of words keeps blanks, brackets and line ends.
    let mut parts: Vec<String> = Vec::new();
    for c in text.chars() {
        let is_word = c.is_alphanumeric() || "+-._".contains(c);
        match parts.last_mut() {
            Some(last) if last.chars().all(|l| l.is_alphanumeric() || "+-._".contains(l)) == is_word => last.push(c),
            _ => parts.push(c.to_string()),
        }
    }
    for (at, odd) in words {
        let n = at.index(parts.len());
        parts[n] = ODD[odd % ODD.len()].to_owned();
    }
    let text = parts.concat();
    let mut rows: Vec<&str> = text.split('\n').collect();
    for (a, b) in lines {
        let (a, b) = (a.index(rows.len()), b.index(rows.len()));
        rows.swap(a, b);
    }
    if let Some(at) = gone {
        let n = at.index(rows.len());
        if n % 2 == 0 {
            rows.remove(n);
        } else {
            rows.insert(n, rows[n]);
        }
    }
    rows.join("\n")
}

/// Whatever was read goes through what a user's file goes through.
fn used(grid: &mut MultiBlock) {
    find_interfaces(grid, &Options::default());
    fill_rest(grid, "rest", Condition::Wall);
    let _ = quality::check(grid).to_string();
    let _ = nmf::format(grid);
    let _ = boundary_file::format(&grid.topology);
}

/// Words to replace and by what, lines to swap, a line to remove or double.
type Changes = (Vec<(Index, usize)>, Vec<(Index, Index)>, Option<Index>);

fn changes() -> impl Strategy<Value = Changes> {
    (
        proptest::collection::vec((any::<Index>(), 0..ODD.len()), 0..4),
        proptest::collection::vec((any::<Index>(), any::<Index>()), 0..2),
        proptest::option::of(any::<Index>()),
    )
}

#[test]
fn files_to_be_broken_are_whole() {
    let [q, grid] = of_records().try_into().unwrap();
    assert_eq!(plot3d::parse_solution("q", &q).unwrap().blocks[0].q.len(), 6);
    assert_eq!(plot3d::parse("grid", &grid).unwrap().blocks[0].nodes(), [3, 2, 2]);
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: std::env::var("DIP_FUZZ_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(1500),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn damaged_plot3d_files_never_panic(bytes in broken_bytes()) {
        if let Ok(read) = plot3d::parse("damaged", &bytes) {
            for block in &read.blocks {
                prop_assert_eq!(block.x.len(), block.node_count());
                prop_assert_eq!(block.z.len(), block.node_count());
            }
            let mut grid = MultiBlock { blocks: read.blocks, ..MultiBlock::default() };
            used(&mut grid);
        }
        let _ = plot3d::parse_solution("damaged", &bytes);
    }

    #[test]
    fn damaged_text_grids_never_panic((words, lines, gone) in changes(), which in any::<Index>()) {
        let texts: Vec<String> = others().into_iter().filter_map(|b| String::from_utf8(b).ok()).collect();
        let text = broken(&texts[which.index(texts.len())], &words, &lines, gone);
        if let Ok(read) = plot3d::parse("damaged", text.as_bytes()) {
            let mut grid = MultiBlock { blocks: read.blocks, ..MultiBlock::default() };
            used(&mut grid);
        }
        let _ = plot3d::parse_solution("damaged", text.as_bytes());
    }

    #[test]
    fn damaged_files_beside_grids_never_panic((words, lines, gone) in changes(), neutral in any::<bool>()) {
        let mut grid = grid();
        let whole = if neutral { nmf::format(&grid).0 } else { boundary_file::format(&grid.topology) };
        let text = broken(&whole, &words, &lines, gone);
        let read = if neutral {
            nmf::parse("x.nmf", &text, &grid).ok()
        } else {
            boundary_file::parse("x.bc.toml", &text, &grid).ok()
        };
        if let Some(topology) = read {
            grid.topology = topology;
            used(&mut grid);
        }
    }

    #[test]
    fn damaged_pairs_of_files_open_or_say_why((words, lines, gone) in changes(), of_grid in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("g.p3d");
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/grids/construct2d.p3d");
        for (extension, here) in [("p3d", of_grid), ("nmf", !of_grid)] {
            let text = std::fs::read_to_string(data.with_extension(extension)).unwrap();
            let text = if here { broken(&text, &words, &lines, gone) } else { text };
            std::fs::write(path.with_extension(extension), text).unwrap();
        }
        match file::open(&path, None) {
            Ok(mut opened) => used(&mut opened.grid),
            // Which file, and something about it.
            Err(e) => prop_assert!(e.to_string().contains("g."), "{}", e),
        }
    }

    #[test]
    fn damaged_ordinates_never_panic((words, lines, gone) in changes(), loops in any::<bool>()) {
        let names = if loops { "meshes/geometry/rae2822.csv" } else { "meshes/geometry/naca65a0048.csv" };
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(names);
        let text = broken(&std::fs::read_to_string(path).unwrap(), &words, &lines, gone);
        let _ = dip_grid::geometry::read_ordinates("x.csv", &text, None);
    }

    #[test]
    fn random_text_never_panics(text in "[-0-9 .*eEdD,\n]{0,200}", junk in "\\PC{0,200}") {
        let _ = plot3d::parse("text", text.as_bytes());
        let _ = plot3d::parse_solution("text", text.as_bytes());
        let grid = grid();
        for content in [&text, &junk] {
            let _ = nmf::parse("x.nmf", &format!("2\n1 2 3 3\n2 3 3 3\n{content}"), &grid);
            let _ = boundary_file::parse("x.toml", content, &grid);
            let _ = dip_grid::geometry::read_ordinates("x.dat", content, None);
        }
    }
}
