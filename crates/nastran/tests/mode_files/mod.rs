//! Mode files made here, byte by byte, read back, cut off anywhere, and scrambled.

use dip_nastran::modes::{ModeTable, read_f06, read_op2, read_op4, read_punch};
use proptest::prelude::*;

/// Two modes over points 3 and 12; values that single precision holds exactly.
fn table() -> ModeTable {
    let value = |mode: usize, point: usize, c: usize| (mode as f64 + 1.0) * 0.25 + point as f64 * 8.0 - c as f64 * 0.5;
    ModeTable {
        eigenvalues: Vec::new(),
        points: vec![3, 12],
        shapes: (0..2)
            .map(|m| (0..2).map(|p| std::array::from_fn(|c| value(m, p, c))).collect())
            .collect(),
    }
}

const EIGENVALUES: [f64; 2] = [256.0, 4096.0];

fn f06() -> String {
    let t = table();
    let mut text =
        String::from("1    TITLE                                          MSC.NASTRAN  6/17/05   PAGE     7\n");
    text += "                                              R E A L   E I G E N V A L U E S\n";
    text += "   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            GENERALIZED         GENERALIZED\n";
    text += "    NO.       ORDER                                                                       MASS              STIFFNESS\n";
    for (i, e) in EIGENVALUES.iter().enumerate() {
        let w = e.sqrt();
        text += &format!(
            "{:9}{:10}{e:20.6E}{w:20.6E}{:20.6E}{:20.6E}{e:20.6E}\n",
            i + 1,
            i + 1,
            w / std::f64::consts::TAU,
            1.0
        );
    }
    for (mode, shape) in t.shapes.iter().enumerate() {
        for (point, row) in t.points.iter().zip(shape) {
            // Each point on its own page, as long models print.
            text += "1    TITLE                                          MSC.NASTRAN  6/17/05   PAGE     8\n";
            text += &format!("      EIGENVALUE = {:14.6E}\n", EIGENVALUES[mode]);
            text += &format!(
                "          CYCLES = {:14.6E}         R E A L   E I G E N V E C T O R   N O .     {:6}\n\n",
                EIGENVALUES[mode].sqrt() / std::f64::consts::TAU,
                mode + 1
            );
            text += "      POINT ID.   TYPE          T1             T2             T3             R1             R2             R3\n";
            text += &format!("{point:14}      G");
            for value in row {
                text += &format!("{value:15.6E}");
            }
            text += "\n";
        }
    }
    // Another table after them must not be taken for a mode.
    text += "1    TITLE                                          MSC.NASTRAN  6/17/05   PAGE     9\n";
    text += "             3      G      9.0E+00      9.0E+00      9.0E+00      9.0E+00      9.0E+00      9.0E+00\n";
    text
}

fn punch() -> String {
    let t = table();
    let mut text = String::new();
    let mut line = |s: String| {
        text += &format!("{s:<72}{:8}\n", 1);
    };
    for (mode, shape) in t.shapes.iter().enumerate() {
        line("$TITLE   = T".into());
        line("$EIGENVECTOR".into());
        line("$REAL OUTPUT".into());
        line(format!(
            "$EIGENVALUE = {:14.7E}  MODE = {:5}",
            EIGENVALUES[mode],
            mode + 1
        ));
        for (point, row) in t.points.iter().zip(shape) {
            line(format!(
                "{point:10}       G{:18.6E}{:18.6E}{:18.6E}",
                row[0], row[1], row[2]
            ));
            line(format!(
                "-CONT-            {:18.6E}{:18.6E}{:18.6E}",
                row[3], row[4], row[5]
            ));
        }
    }
    text
}

/// Writes op2 records.
struct Writer {
    bytes: Vec<u8>,
    little: bool,
    word: usize,
}

impl Writer {
    fn integer(&self, i: i64) -> Vec<u8> {
        let mut b = if self.word == 4 {
            (i as i32).to_le_bytes().to_vec()
        } else {
            i.to_le_bytes().to_vec()
        };
        if !self.little {
            b.reverse();
        }
        b
    }

    fn real(&self, x: f64) -> Vec<u8> {
        let mut b = if self.word == 4 {
            (x as f32).to_le_bytes().to_vec()
        } else {
            x.to_le_bytes().to_vec()
        };
        if !self.little {
            b.reverse();
        }
        b
    }

    fn text(&self, s: &str, words: usize) -> Vec<u8> {
        let padded = format!("{s:<width$}", width = 4 * words);
        padded
            .as_bytes()
            .chunks(4)
            .flat_map(|c| [c, &b"    "[..self.word - 4]].concat())
            .collect()
    }

    fn block(&mut self, data: &[u8]) {
        let mut length = (data.len() as u32).to_le_bytes();
        if !self.little {
            length.reverse();
        }
        self.bytes.extend(length);
        self.bytes.extend(data);
        self.bytes.extend(length);
    }

    fn marker(&mut self, m: i64) {
        let b = self.integer(m);
        self.block(&b);
    }

    fn record(&mut self, data: &[u8]) {
        self.marker((data.len() / self.word) as i64);
        self.block(data);
    }

    fn table(&mut self, name: &str, records: &[Vec<u8>]) {
        let name_words = self.text(name, 2);
        self.record(&name_words);
        self.marker(-1);
        let trailer = self.integer(1).repeat(7);
        self.record(&trailer);
        self.marker(-2);
        self.marker(1);
        self.marker(0);
        self.record(&name_words);
        for (i, record) in records.iter().enumerate() {
            self.marker(-3 - i as i64);
            self.marker(1);
            self.marker(0);
            // A long record comes in pieces.
            let half = record.len() / self.word / 2 * self.word;
            if half > 0 {
                self.record(&record[..half]);
            }
            self.record(&record[half..]);
        }
        self.marker(-3 - records.len() as i64);
        self.marker(1);
        self.marker(0);
        self.marker(0);
    }
}

fn op2(little: bool, word: usize, label: bool) -> Vec<u8> {
    let t = table();
    let mut w = Writer {
        bytes: Vec::new(),
        little,
        word,
    };
    if label {
        w.marker(3);
        let date = w.integer(1).repeat(3);
        w.block(&date);
        let text = w.text("NASTRAN FORT TAPE ID CODE - ", 7);
        w.record(&text);
        let version = w.text("XXXXXXXX", 2);
        w.record(&version);
        w.marker(-1);
        w.marker(0);
    }
    let grid = |id: i64, x: f64| {
        [
            w.integer(id),
            w.integer(0),
            w.real(x),
            w.real(2.0),
            w.real(3.0),
            w.integer(0),
            w.integer(0),
            w.integer(0),
        ]
        .concat()
    };
    let key: Vec<u8> = [w.integer(4501), w.integer(45), w.integer(1)].concat();
    let geometry = [key, grid(3, 1.5), grid(12, 2.5)].concat();
    let header = |mode: i64, eigenvalue: f64| -> Vec<u8> {
        let mut words: Vec<Vec<u8>> = (0..146).map(|_| w.integer(0)).collect();
        words[0] = w.integer(21);
        words[1] = w.integer(7);
        words[4] = w.integer(mode);
        words[5] = w.real(eigenvalue);
        words[8] = w.integer(1);
        words[9] = w.integer(8);
        words.concat()
    };
    let mut vectors = Vec::new();
    for (mode, shape) in t.shapes.iter().enumerate() {
        vectors.push(header(mode as i64 + 1, EIGENVALUES[mode]));
        let mut rows = Vec::new();
        for (point, row) in t.points.iter().zip(shape) {
            rows.extend(w.integer(i64::from(*point) * 10 + 1));
            rows.extend(w.integer(1));
            for value in row {
                rows.extend(w.real(*value));
            }
        }
        vectors.push(rows);
    }
    let mut lama = Vec::new();
    for (i, e) in EIGENVALUES.iter().enumerate() {
        lama.extend(w.integer(i as i64 + 1));
        lama.extend(w.integer(i as i64 + 1));
        for value in [*e, e.sqrt(), e.sqrt() / std::f64::consts::TAU, 1.0, *e] {
            lama.extend(w.real(value));
        }
    }
    let lama_header = header(0, 0.0);
    w.table("GEOM1", &[geometry]);
    w.table("LAMA", &[lama_header, lama]);
    w.table("OUGV1", &vectors);
    w.marker(0);
    w.bytes
}

/// A 3 x 2 matrix with zeros: dense text, and sparse and dense binary.
const OP4: [[f64; 3]; 2] = [[0.0, 1.5, -2.0], [4.0, 0.0, 8.0]];

fn op4_text() -> String {
    let mut text = String::from("       2       3       2       2PHIG    1P,3E23.16\n");
    for (j, column) in OP4.iter().enumerate() {
        text += &format!("{:8}{:8}{:8}\n", j + 1, 1, 3);
        for value in column {
            text += &format!("{value:23.16E}");
        }
        text += "\n";
    }
    text + "       3       1       1\n 1.0000000000000000E+00\n"
}

fn op4_binary(sparse: bool) -> Vec<u8> {
    let mut w = Writer {
        bytes: Vec::new(),
        little: true,
        word: 4,
    };
    let i = |w: &Writer, list: &[i64]| -> Vec<u8> { list.iter().flat_map(|x| w.integer(*x)).collect() };
    let header = [i(&w, &[2, 3, 2, 2]), b"PHIG    ".to_vec()].concat();
    w.block(&header);
    for (j, column) in OP4.iter().enumerate() {
        let bytes =
            |range: std::ops::Range<usize>| -> Vec<u8> { column[range].iter().flat_map(|x| x.to_le_bytes()).collect() };
        let data = if sparse {
            // Strings: (length in words + 1) * 65536 + row, then the values.
            let strings: &[(usize, usize)] = if j == 0 { &[(1, 3)] } else { &[(0, 1), (2, 3)] };
            let mut data = Vec::new();
            for (from, to) in strings {
                data.extend(i(&w, &[((2 * (to - from) + 1) * 65536 + from + 1) as i64]));
                data.extend(bytes(*from..*to));
            }
            [i(&w, &[j as i64 + 1, 0, (data.len() / 4) as i64]), data].concat()
        } else {
            [i(&w, &[j as i64 + 1, 1, 6]), bytes(0..3)].concat()
        };
        w.block(&data);
    }
    let end = [i(&w, &[3, 1, 2]), 1.0_f64.to_le_bytes().to_vec()].concat();
    w.block(&end);
    w.bytes
}

fn check(read: &ModeTable) {
    let t = table();
    assert_eq!(read.points, t.points);
    assert_eq!(read.shapes, t.shapes);
    assert_eq!(read.eigenvalues.len(), 2);
    for (e, expected) in read.eigenvalues.iter().zip(EIGENVALUES) {
        assert!((e.eigenvalue / expected - 1.0).abs() < 1e-6);
        assert!((e.freq_hz * std::f64::consts::TAU / expected.sqrt() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn every_format_gives_the_same_modes() {
    check(&read_f06(&f06()).unwrap());
    check(&read_punch(&punch()).unwrap());
    for little in [true, false] {
        for word in [4, 8] {
            for label in [true, false] {
                let read = read_op2(&op2(little, word, label)).unwrap();
                check(&read.table);
                assert_eq!(
                    read.grids.iter().map(|g| (g.id, g.position[0])).collect::<Vec<_>>(),
                    [(3, 1.5), (12, 2.5)]
                );
                assert_eq!(read.table.eigenvalues[0].generalized_mass, Some(1.0));
            }
        }
    }
}

#[test]
fn op4_matrices_are_read_dense_and_sparse() {
    for bytes in [op4_text().into_bytes(), op4_binary(false), op4_binary(true)] {
        let found = read_op4(&bytes).unwrap();
        assert_eq!(
            (found.len(), found[0].name.as_str(), found[0].rows, found[0].columns),
            (1, "PHIG", 3, 2)
        );
        assert_eq!(found[0].real, OP4.concat());
    }
}

#[test]
fn a_file_cut_off_anywhere_is_refused_or_read_short_and_never_more() {
    let bytes = op2(true, 4, true);
    // The last twelve bytes are the marker behind the last table; without it the tables are still whole.
    for end in 0..bytes.len() - 12 {
        assert!(read_op2(&bytes[..end]).is_err(), "{end}");
    }
    let bytes = op4_binary(true);
    for end in 0..bytes.len() {
        assert!(read_op4(&bytes[..end]).is_err(), "{end}");
    }
    for text in [f06(), punch(), op4_text()] {
        for end in (0..text.len()).step_by(7) {
            let part = &text[..end];
            let _ = (
                read_f06(part).is_ok(),
                read_punch(part).is_ok(),
                read_op4(part.as_bytes()).is_ok(),
            );
        }
    }
}

#[test]
fn a_file_without_modes_says_what_to_ask_for() {
    assert!(read_f06("nothing\n").unwrap_err().to_string().contains("VECTOR(PRINT)"));
    assert!(
        read_punch("nothing\n")
            .unwrap_err()
            .to_string()
            .contains("VECTOR(PUNCH)")
    );
    assert!(read_op2(b"nothing at all").unwrap_err().to_string().contains("op2"));
    assert!(read_op4(b"").unwrap_err().to_string().contains("op4"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn scrambled_files_never_panic(place in 0usize..4000, value in any::<[u8; 4]>(), little: bool) {
        let mut bytes = op2(little, 4, true);
        let at = place % (bytes.len() - 4);
        bytes[at..at + 4].copy_from_slice(&value);
        let _ = read_op2(&bytes);
        for mut bytes in [op4_binary(true), op4_binary(false), op4_text().into_bytes()] {
            let at = place % (bytes.len() - 4);
            bytes[at..at + 4].copy_from_slice(&value);
            let _ = read_op4(&bytes);
        }
        for text in [f06(), punch()] {
            let mut bytes = text.into_bytes();
            let at = place % (bytes.len() - 4);
            bytes[at..at + 4].copy_from_slice(&value);
            let text = String::from_utf8_lossy(&bytes);
            let _ = (read_f06(&text).is_ok(), read_punch(&text).is_ok());
        }
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let _ = (read_op2(&bytes).is_ok(), read_op4(&bytes).is_ok());
        let text = String::from_utf8_lossy(&bytes);
        let _ = (read_f06(&text).is_ok(), read_punch(&text).is_ok());
    }
}
