//! What must hold exactly: documents are well formed, nothing is lost or made up, the same data gives the same bytes.

use dip_report::{
    Block, BoundaryCurve, BoundaryPoint, Cell, Chart, ColorMap, Column, CpCut, CrossingKind, Figure, Legend, Marker,
    Mesh, NumberFormat, Page, ReportError, Series, Style, Table, VgCrossing, VgMode,
};
use roxmltree::{Document, Node};

const NASTY: &str = "<b>&\"quotes\" 'single' ]]> \u{1} _{x} µ 翼";

fn parse(svg: &str) -> Document<'_> {
    let document = Document::parse(svg).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    for attribute in document.descendants().flat_map(|n| n.attributes().collect::<Vec<_>>()) {
        let value = attribute.value();
        assert!(
            !value.contains("NaN") && !value.contains("inf"),
            "{}=\"{value}\"",
            attribute.name()
        );
    }
    document
}

fn series_groups<'a>(document: &'a Document<'_>) -> Vec<Node<'a, 'a>> {
    document
        .descendants()
        .filter(|n| n.attribute("class") == Some("series"))
        .collect()
}

fn texts(document: &Document<'_>) -> Vec<String> {
    let all = document
        .descendants()
        .filter(|n| n.has_tag_name("text") || n.tag_name().name() == "text");
    all.map(|n| {
        n.descendants()
            .filter_map(|d| d.is_text().then(|| d.text()).flatten())
            .collect()
    })
    .collect()
}

fn shapes(group: Node<'_, '_>, name: &str) -> usize {
    group.descendants().filter(|n| n.tag_name().name() == name).count()
}

/// The numbers of all coordinates in path data.
fn path_points(data: &str) -> Vec<(f64, f64)> {
    data.split(['M', 'L', 'Z'])
        .filter(|part| !part.is_empty())
        .map(|part| {
            let (x, y) = part.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        })
        .collect()
}

#[test]
fn every_series_is_drawn_in_its_style() {
    let points = vec![(0.0, 1.0), (1.0, 2.0), (2.0, 1.5)];
    let mut chart = Chart::new("styles", "x", "y");
    let mut styles = vec![Style::Line, Style::Dashed, Style::Dotted];
    for marker in Marker::ALL {
        styles.extend([
            Style::Markers(marker),
            Style::LineMarkers(marker),
            Style::DashedMarkers(marker),
        ]);
    }
    for (i, style) in styles.iter().enumerate() {
        chart = chart.series(Series::new(format!("series {i}"), points.clone(), *style));
    }
    let svg = chart.svg(900, 700).unwrap();
    let document = parse(&svg);
    let groups = series_groups(&document);
    assert_eq!(groups.len(), styles.len());
    for (group, style) in groups.iter().zip(&styles) {
        let expected = match style {
            Style::Line | Style::Dashed | Style::Dotted => 1,
            Style::Markers(_) => 3,
            Style::LineMarkers(_) | Style::DashedMarkers(_) => 4,
        };
        assert_eq!(shapes(*group, "path") + shapes(*group, "circle"), expected, "{style:?}");
    }
    for i in 0..styles.len() {
        assert!(
            texts(&document).contains(&format!("series {i}")),
            "no legend entry for series {i}"
        );
    }
}

#[test]
fn positions_are_exact() {
    // Limits are given, so data maps linearly from frame to frame.
    let corners = vec![(10.0, -1.0), (20.0, 3.0), (15.0, 1.0)];
    let chart = Chart::new("", "x", "y")
        .x_range(10.0, 20.0)
        .y_range(-1.0, 3.0)
        .series(Series::line("", corners));
    for inverted in [false, true] {
        let chart = if inverted {
            chart.clone().invert_y()
        } else {
            chart.clone()
        };
        let svg = chart.svg(500, 400).unwrap();
        let document = parse(&svg);
        let line = series_groups(&document)[0]
            .descendants()
            .find(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "path")));
        let p = path_points(line.unwrap().attribute("d").unwrap());
        assert_eq!(p.len(), 3);
        assert!(p[0].0 < p[1].0 && (p[0].1 < p[1].1) == inverted);
        assert!((p[2].0 - 0.5 * (p[0].0 + p[1].0)).abs() < 0.011 && (p[2].1 - 0.5 * (p[0].1 + p[1].1)).abs() < 0.011);
    }
}

#[test]
fn a_logarithmic_axis_spaces_decades_evenly() {
    let points = vec![(0.0, 1e-8), (1.0, 1e-4), (2.0, 1.0)];
    let svg = Chart::new("", "x", "y")
        .log_y()
        .series(Series::line("", points))
        .svg(500, 400)
        .unwrap();
    let document = parse(&svg);
    let path = series_groups(&document)[0].first_element_child().unwrap();
    let p = path_points(path.attribute("d").unwrap());
    assert!((p[0].1 - p[1].1 - (p[1].1 - p[2].1)).abs() < 0.03, "{p:?}");
}

#[test]
fn points_without_a_value_are_gaps_and_are_told() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e301];
    for value in bad {
        let points = vec![(0.0, 1.0), (1.0, 2.0), (2.0, value), (3.0, 2.0), (4.0, 1.0)];
        let svg = Chart::new("gap", "x", "y")
            .series(Series::line("a", points))
            .svg(500, 400)
            .unwrap();
        let document = parse(&svg);
        let path = series_groups(&document)[0]
            .first_element_child()
            .unwrap()
            .attribute("d")
            .unwrap();
        assert_eq!(path.matches('M').count(), 2, "{value}: two pieces with a gap between");
        assert!(svg.contains("1 points have no value that can be drawn"));
    }
    let points = vec![(0.0, 1.0), (1.0, 0.0), (2.0, -3.0), (3.0, 2.0)];
    let chart = Chart::new("log", "x", "y")
        .log_y()
        .series(Series::markers("a", points, Marker::Square));
    let svg = chart.svg(500, 400).unwrap();
    let document = parse(&svg);
    assert_eq!(shapes(series_groups(&document)[0], "path"), 2);
    assert!(svg.contains("2 points have no value"));
}

#[test]
fn a_lone_point_of_a_line_is_seen() {
    for points in [
        vec![(1.0, 1.0)],
        vec![(0.0, f64::NAN), (1.0, 1.0), (2.0, f64::NAN)],
        vec![(1.0, 1.0); 3],
    ] {
        let svg = Chart::new("", "x", "y")
            .series(Series::line("", points))
            .svg(400, 300)
            .unwrap();
        let document = parse(&svg);
        assert_eq!(shapes(series_groups(&document)[0], "circle"), 1);
    }
}

#[test]
fn empty_and_constant_data_make_a_chart_with_ticks() {
    let cases: Vec<Vec<(f64, f64)>> = vec![
        vec![],
        vec![(f64::NAN, f64::NAN)],
        vec![(0.0, 0.0)],
        vec![(1.0, 5.0), (2.0, 5.0)],
        vec![(3.0, 1.0), (3.0, 2.0)],
        vec![(0.0, 5e-324), (1.0, 1e-320)],
        vec![(0.0, -9e299), (1.0, 9e299)],
        vec![(1e15, 1.0), (1e15 + 2.0, 1.0 + 2e-16)],
    ];
    for points in cases {
        for logarithmic in [false, true] {
            let mut chart = Chart::new("", "x", "y").series(Series::line_markers("s", points.clone(), Marker::Circle));
            if logarithmic {
                chart = chart.log_x().log_y();
            }
            let svg = chart.svg(500, 400).unwrap_or_else(|e| panic!("{points:?}: {e}"));
            let document = parse(&svg);
            assert!(
                texts(&document).len() >= 6,
                "{points:?} log {logarithmic}: {:?}",
                texts(&document)
            );
        }
    }
}

#[test]
fn ticks_are_sensible_over_24_decades() {
    for e in -12..=12 {
        let scale = 10f64.powi(e);
        let points = vec![(0.0, 0.13 * scale), (1.0, 0.94 * scale)];
        let svg = Chart::new("", "", "")
            .series(Series::line("", points))
            .svg(600, 400)
            .unwrap();
        let document = parse(&svg);
        let labels = texts(&document);
        assert!((8..=22).contains(&labels.len()), "1e{e}: {labels:?}");
        assert!(labels.iter().all(|l| l.chars().count() <= 8), "1e{e}: {labels:?}");
    }
}

#[test]
fn nothing_is_drawn_outside_the_frame() {
    let points: Vec<(f64, f64)> = (0..400)
        .map(|i| f64::from(i) * 0.1)
        .map(|x| (x, 50.0 * (x * 0.7).sin()))
        .collect();
    let chart = Chart::new("", "x", "y").x_range(5.0, 20.0).y_range(-10.0, 10.0);
    let svg = chart
        .series(Series::line_markers("", points, Marker::Circle))
        .svg(500, 400)
        .unwrap();
    let document = parse(&svg);
    let group = series_groups(&document)[0];
    for node in group.descendants() {
        if let Some(d) = node.attribute("d") {
            assert!(
                path_points(d)
                    .iter()
                    .all(|p| p.0 > 30.0 && p.0 < 490.0 && p.1 > 5.0 && p.1 < 370.0)
            );
        }
        if let Some(cx) = node.attribute("cx") {
            assert!(cx.parse::<f64>().unwrap() < 490.0);
        }
    }
}

#[test]
fn the_legend_covers_no_data() {
    // Curves through all corners and edges: there is no room inside, so the legend has to leave the plot.
    let mut chart = Chart::new("", "x", "y");
    for i in 0..12 {
        let level = f64::from(i);
        chart = chart.series(Series::line(
            format!("a rather long name {i}"),
            vec![(0.0, level), (1.0, level)],
        ));
    }
    let svg = chart.svg(700, 420).unwrap();
    let document = parse(&svg);
    let right = series_groups(&document)
        .iter()
        .filter_map(Node::first_element_child)
        .flat_map(|p| path_points(p.attribute("d").unwrap()))
        .fold(0.0_f64, |m, p| m.max(p.0));
    let legend = document
        .descendants()
        .find(|n| n.attribute("class") == Some("legend"))
        .unwrap();
    let left = legend
        .descendants()
        .filter_map(|n| n.attribute("x1"))
        .map(|x| x.parse::<f64>().unwrap());
    assert!(left.fold(f64::INFINITY, f64::min) > right);
}

#[test]
fn notes_go_where_they_hide_nothing_and_all_are_written() {
    let line: Vec<(f64, f64)> = (0..=100).map(|i| f64::from(i) * 0.1).map(|x| (x, x.sin())).collect();
    let mut chart = Chart::new("", "x", "y")
        .series(Series::line("s", line))
        .vline(3.0, "here")
        .hline(0.2, "there");
    for i in 0..5 {
        chart = chart.mark(f64::from(i) * 2.0, (f64::from(i) * 2.0).sin(), format!("note {i}"));
    }
    let svg = chart.svg(700, 500).unwrap();
    let written = texts(&parse(&svg));
    for word in ["here", "there", "note 0", "note 1", "note 2", "note 3", "note 4"] {
        assert!(written.iter().any(|t| t == word), "{word} is missing");
    }
}

#[test]
fn text_is_escaped_everywhere() {
    let chart = Chart::new(NASTY, NASTY, NASTY)
        .series(Series::line(NASTY, vec![(0.0, 0.0), (1.0, 1.0)]).color("\"/><script>"))
        .mark(0.5, 0.5, NASTY)
        .vline(0.2, NASTY)
        .hline(0.3, NASTY);
    let figure = Figure::new(NASTY).row(vec![chart]);
    let svg = figure.svg(700, 500).unwrap();
    parse(&svg);
    assert!(!svg.contains("<b>") && !svg.contains("<script"));
    let mut table = Table::new(NASTY, vec![Column::number(NASTY, NASTY, NumberFormat::Fixed(1))]);
    table.push(vec![NASTY.into()]).unwrap();
    let blocks = vec![
        Block::Paragraph(NASTY.to_owned()),
        Block::Heading(NASTY.to_owned()),
        Block::List(vec![NASTY.to_owned()]),
        Block::Warning(NASTY.to_owned()),
        Block::Table(table.clone()),
        Block::figure(&figure, 700, 500, NASTY).unwrap(),
        Block::figure(&figure, 700, 500, NASTY).unwrap(),
        Block::Pairs(vec![(NASTY.to_owned(), NASTY.to_owned())]),
        Block::Details {
            summary: NASTY.to_owned(),
            text: NASTY.to_owned(),
        },
    ];
    let html = Page::new(NASTY)
        .stamp(NASTY, NASTY)
        .section(NASTY, blocks.clone())
        .section(NASTY, blocks)
        .html();
    assert!(!html.contains("<b>&") && !html.contains("<script") && !html.contains("http://www.w3.org/1999"));
    let document = Document::parse(html.strip_prefix("<!DOCTYPE html>\n").unwrap()).unwrap();
    let mut ids: Vec<&str> = document.descendants().filter_map(|n| n.attribute("id")).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "an id stands twice");
    for link in document.descendants().filter_map(|n| n.attribute("href")) {
        assert!(ids.contains(&&link[1..]), "{link} leads nowhere");
    }
    assert_eq!(table.csv().lines().count(), 2);
}

#[test]
fn pages_can_be_read_without_seeing() {
    let figure = Figure::new("").row(vec![Chart::new("Lift", "Angle, deg", "C_{L}")]);
    let mut table = Table::new(
        "Lift",
        vec![Column::text("Case"), Column::number("CL", "", NumberFormat::Fixed(3))],
    );
    table.push(vec!["a".into(), Cell::from(0.27).warning()]).unwrap();
    let html = Page::new("Page")
        .section(
            "One",
            vec![Block::figure(&figure, 400, 300, "Lift.").unwrap(), Block::Table(table)],
        )
        .html();
    let document = Document::parse(html.strip_prefix("<!DOCTYPE html>\n").unwrap()).unwrap();
    let by_name = |name: &'static str| document.descendants().filter(move |n| n.tag_name().name() == name);
    assert_eq!(document.root_element().attribute("lang"), Some("en"));
    for svg in by_name("svg") {
        assert_eq!(svg.attribute("role"), Some("img"));
        assert_eq!(svg.attribute("aria-label"), Some("Lift"));
    }
    assert!(by_name("th").all(|th| th.attribute("scope").is_some()));
    assert!(by_name("caption").count() == 1 && by_name("figcaption").count() == 1);
    assert!(
        html.contains("title=\"warning\""),
        "warnings are not told by colour alone"
    );
    assert!(by_name("script").count() == 0 && by_name("link").count() == 0 && by_name("img").count() == 0);
}

#[test]
fn the_same_data_gives_the_same_bytes() {
    let make = || {
        let wave = (0..500)
            .map(|i| f64::from(i) * 0.02)
            .map(|x| (x, x.sin() / (1.0 + x)))
            .collect();
        let chart = Chart::new("t", "x", "y")
            .series(Series::line("a", wave))
            .mark(1.0, 0.42, "top");
        Figure::new("f").row(vec![chart.clone(), chart]).svg(900, 400).unwrap()
    };
    assert_eq!(make(), make());
}

#[test]
fn what_cannot_be_drawn_is_refused_with_the_reason() {
    let line = || Series::line("s", vec![(1.0, 1.0), (2.0, 2.0)]);
    let chart = || Chart::new("c", "x", "y").series(line());
    assert!(matches!(chart().svg(80, 60), Err(ReportError::Size { .. })));
    assert!(matches!(chart().svg(0, 0), Err(ReportError::Size { .. })));
    let Err(ReportError::Size {
        needed_width_px,
        needed_height_px,
        ..
    }) = chart().svg(90, 70)
    else {
        panic!()
    };
    chart()
        .svg(needed_width_px, needed_height_px)
        .expect("the size that was named is enough");
    for (a, b) in [(1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        assert!(matches!(
            chart().x_range(a, b).svg(400, 300),
            Err(ReportError::Range { axis: "x", .. })
        ));
    }
    assert!(matches!(
        chart().log_y().y_range(0.0, 1.0).svg(400, 300),
        Err(ReportError::Range { axis: "y", .. })
    ));
    let short = Chart::new("c", "x", "y").series(line().y_error(vec![(0.1, 0.1)]));
    assert!(matches!(
        short.svg(400, 300),
        Err(ReportError::Shape { needed: 2, got: 1, .. })
    ));
    assert!(matches!(Figure::new("f").svg(400, 300), Err(ReportError::Empty { .. })));
    let mut table = Table::new("t", vec![Column::text("a")]);
    assert!(table.push(vec![]).is_err());
    assert!(dip_report::mode_map("m", &Mesh::default(), &[], "z").is_err());
    let broken = Mesh {
        nodes: vec![[0.0; 3]; 3],
        elements: vec![vec![0, 1, 7]],
    };
    assert!(matches!(
        dip_report::mode_map("m", &broken, &[0.0; 3], "z"),
        Err(ReportError::Shape { .. })
    ));
    assert!(dip_report::lattice("l", &[], &[1.0], "v", ColorMap::Sequential, &[]).is_err());
    assert!(dip_report::lattice("l", &[], &[], "v", ColorMap::Sequential, &[0]).is_err());
    assert!(dip_report::cp_cuts("c", &[], 2).is_err() && dip_report::cp_cuts("c", &[CpCut::default()], 0).is_err());
    let lame = VgMode {
        label: "m".to_owned(),
        speed_m_s: vec![1.0],
        damping_g: vec![],
        freq_hz: vec![1.0],
    };
    assert!(dip_report::vg("v", &[lame], &[]).is_err());
}

#[test]
fn vg_shares_the_axis_and_names_the_crossings() {
    let speed_m_s = vec![0.0, 100.0, 200.0, 300.0];
    let mode = VgMode {
        label: "mode 1".to_owned(),
        speed_m_s: speed_m_s.clone(),
        damping_g: vec![0.0, -0.05, 40.0, f64::NAN],
        freq_hz: vec![9.6, 10.0, 11.0, 12.0],
    };
    let flutter = VgCrossing {
        kind: CrossingKind::Flutter,
        speed_m_s: 101.234,
        freq_hz: 10.05,
        damping_g: 0.0,
    };
    let divergence = VgCrossing {
        kind: CrossingKind::Divergence,
        speed_m_s: 280.0,
        freq_hz: 0.0,
        damping_g: 0.0,
    };
    let svg = dip_report::vg("V-g", &[mode], &[flutter, divergence])
        .unwrap()
        .svg(700, 700)
        .unwrap();
    let written = texts(&parse(&svg));
    for word in ["flutter 101.2 m/s", "10.05 Hz", "divergence 280.0 m/s", "mode 1"] {
        assert_eq!(written.iter().filter(|t| *t == word).count(), 1, "{word}: {written:?}");
    }
    assert_eq!(
        written.iter().filter(|t| *t == "Speed, m/s").count(),
        1,
        "the shared axis is named once"
    );
    assert_eq!(
        written.iter().filter(|t| *t == "150").count() % 2,
        0,
        "both charts have the same ticks"
    );
}

#[test]
fn the_boundary_marks_experiment_and_leaves_out_what_is_unknown() {
    let point = |mach, speed_index, frequency_ratio| BoundaryPoint {
        mach,
        speed_index,
        speed_index_error: (0.01, 0.02),
        frequency_ratio,
    };
    let curve = |experiment, ratio| BoundaryCurve {
        label: if experiment { "test" } else { "DLM" }.to_owned(),
        points: vec![point(0.5, 0.446, ratio), point(0.9, 0.37, ratio)],
        experiment,
    };
    let known = dip_report::boundary("b", &[curve(false, 0.5), curve(true, 0.5)]);
    assert_eq!(known.rows.len(), 2);
    let svg = known.svg(600, 700).unwrap();
    let document = parse(&svg);
    assert_eq!(series_groups(&document).len(), 4);
    assert_eq!(
        shapes(series_groups(&document)[1], "line"),
        6,
        "two bars with two caps each"
    );
    let unknown = dip_report::boundary("b", &[curve(false, f64::NAN)]);
    assert_eq!(unknown.rows.len(), 1);
}

#[test]
fn a_mode_picture_fills_the_planform_and_draws_the_node_line() {
    let mut mesh = Mesh::default();
    for j in 0..=4 {
        for i in 0..=4 {
            mesh.nodes.push([f64::from(i), f64::from(j), 0.0]);
        }
    }
    for n in (0..20).filter(|n| n % 5 != 4) {
        mesh.elements.push(vec![n, n + 1, n + 6, n + 5]);
    }
    let z: Vec<f64> = mesh.nodes.iter().map(|n| n[0] - 1.3).collect();
    let chart = dip_report::mode_map("torsion", &mesh, &z, "z, m").unwrap();
    let area = |p: &[(f64, f64)]| {
        0.5 * p
            .iter()
            .zip(p.iter().cycle().skip(1))
            .map(|(a, b)| a.0 * b.1 - b.0 * a.1)
            .sum::<f64>()
            .abs()
    };
    let filled: f64 = chart.patches.iter().flat_map(|p| &p.polygons).map(|p| area(p)).sum();
    assert!((filled - 16.0).abs() < 1e-12, "{filled}");
    let lines: Vec<&Series> = chart.series.iter().filter(|s| s.label == "node line").collect();
    assert_eq!(lines.len(), 1);
    assert!(lines[0].points.iter().all(|p| (p.1 - 1.3).abs() < 1e-14));
    parse(&chart.svg(600, 500).unwrap());
    let lift: Vec<[f64; 3]> = z.iter().map(|z| [0.0, 0.0, *z]).collect();
    let view = dip_report::mode_view("torsion", &mesh, &lift, None).unwrap();
    assert_eq!(view.patches.len(), 1 + mesh.elements.len());
    parse(&view.svg(600, 400).unwrap());
    let mut holes = z.clone();
    holes[6] = f64::NAN;
    let told = dip_report::mode_map("torsion", &mesh, &holes, "z, m").unwrap();
    assert!(told.color_bar.as_ref().unwrap().label.contains("1 nodes without"));
    parse(&told.svg(600, 500).unwrap());
}

#[test]
fn equal_scale_is_equal() {
    let square = vec![(0.0, 0.0), (0.3, 0.0), (0.3, 0.3), (0.0, 0.3), (0.0, 0.0)];
    let chart = Chart::new("", "x", "y")
        .equal_scale()
        .series(Series::line("", square))
        .legend(Legend::Hidden);
    for (w, h) in [(900, 300), (300, 700)] {
        let svg = chart.svg(w, h).unwrap();
        let document = parse(&svg);
        let path = series_groups(&document)[0].first_element_child().unwrap();
        let p = path_points(path.attribute("d").unwrap());
        let (dx, dy) = ((p[1].0 - p[0].0).abs(), (p[2].1 - p[1].1).abs());
        assert!((dx - dy).abs() < 0.03, "{dx} {dy}");
    }
}

#[test]
fn a_lattice_shows_every_box_and_says_what_has_no_value() {
    let at = |i: usize| {
        [
            [0.0, i as f64],
            [1.0, i as f64],
            [1.0, i as f64 + 1.0],
            [0.0, i as f64 + 1.0],
        ]
    };
    let boxes: Vec<_> = (0..5).map(at).collect();
    let values = [1.0, 2.0, f64::NAN, -3.0, 0.5];
    let worst = dip_report::worst_boxes(&values, 1.0, 2);
    let chart = dip_report::lattice("l", &boxes, &values, "W", ColorMap::Diverging, &worst).unwrap();
    assert_eq!(chart.patches.iter().filter(|p| p.fill.is_some()).count(), 5);
    let svg = chart.svg(700, 400).unwrap();
    let written = texts(&parse(&svg));
    assert!(written.iter().any(|t| t == "box 3: \u{2212}3.00"), "{written:?}");
    assert!(
        written.iter().any(|t| t.contains("grey: 1 boxes without")),
        "{written:?}"
    );
}

#[test]
fn tables_say_the_same_in_every_form() {
    let mut table = Table::new(
        "Speeds",
        vec![
            Column::text("Method, kind"),
            Column::number("U", "m/s", NumberFormat::Significant(4)),
        ],
    );
    table.push(vec!["a|b".into(), Cell::from(1234.5678)]).unwrap();
    table
        .push(vec!["say \"so\"".into(), Cell::from(f64::NAN).warning()])
        .unwrap();
    table.push(vec!["none".into(), Cell::missing()]).unwrap();
    let plain = table.plain();
    let rows: Vec<&str> = plain.lines().collect();
    assert_eq!(rows[0], "Speeds");
    assert!(
        rows[1].ends_with("U [m/s]") && rows[3].ends_with("1235") && rows[4].ends_with("NaN !"),
        "{plain}"
    );
    assert_eq!(
        table.csv(),
        "\"Method, kind\",U [m/s]\na|b,1234.5678\n\"say \"\"so\"\"\",NaN\nnone,\n"
    );
    let markdown = table.markdown();
    let widths: Vec<usize> = markdown.lines().map(|l| l.chars().count()).collect();
    assert!(widths.iter().all(|w| *w == widths[0]), "{markdown}");
    assert!(markdown.contains("a\\|b") && markdown.contains("**NaN**"));
}

#[test]
fn no_data_makes_it_stumble() {
    // A fixed sequence (Knuth's MMIX generator) of awkward numbers in all settings.
    let mut state = 1_u64;
    let mut next = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let awkward = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-300,
        5e-324,
        1e299,
        -1e299,
        1e308,
        f64::MAX,
        0.1,
        1e15,
        f64::NAN,
        f64::INFINITY,
    ];
    for _ in 0..400 {
        let mut value = || {
            let pick = next(2 * awkward.len());
            awkward
                .get(pick)
                .copied()
                .unwrap_or_else(|| next(1000) as f64 * 0.01 - 3.0)
        };
        let points: Vec<(f64, f64)> = (0..7).map(|_| (value(), value())).collect();
        let errors: Vec<(f64, f64)> = (0..7).map(|_| (value(), value())).collect();
        let mut chart = Chart::new("t", "x", "y")
            .series(
                Series::line_markers("a", points.clone(), Marker::Plus)
                    .y_error(errors.clone())
                    .x_error(errors),
            )
            .mark(value(), value(), "note")
            .vline(value(), "v")
            .hline(value(), "h");
        chart.patches.push(dip_report::Patch {
            polygons: vec![points],
            fill: None,
            rim: None,
        });
        let settings = next(16);
        if settings & 1 > 0 {
            chart = chart.log_x();
        }
        if settings & 2 > 0 {
            chart = chart.log_y();
        }
        if settings & 4 > 0 {
            chart = chart.invert_y();
        }
        chart.equal_scale = settings & 8 > 0 && settings & 3 == 0;
        parse(&chart.svg(300 + next(400) as u32, 250 + next(300) as u32).unwrap());
    }
}
