//! A wing made of straight panels between sections; shared by lattice, structure and grid recipes.

use crate::airfoil::Airfoil;
use crate::diagnose::CaseError;
use crate::document::Document;
use crate::file::WingFile;

/// One section of a wing.
#[derive(Debug, Clone)]
pub struct Section {
    /// Leading edge (x, y, z), m.
    pub leading_edge_m: [f64; 3],
    /// Chord along x, m.
    pub chord_m: f64,
    /// Twist about the leading edge, rad, positive nose up.
    pub twist_rad: f64,
    /// Ordinates over the chord, where the file names them.
    pub airfoil: Option<Airfoil>,
}

impl Section {
    /// Point at `x/c` on the chord line, m.
    pub fn point(&self, x_over_c: f64) -> [f64; 3] {
        let [x, y, z] = self.leading_edge_m;
        let (sin, cos) = self.twist_rad.sin_cos();
        [x + self.chord_m * x_over_c * cos, y, z - self.chord_m * x_over_c * sin]
    }
}

/// A wing: sections from root to tip.
#[derive(Debug, Clone)]
pub struct Wing {
    /// Name for titles.
    pub name: String,
    /// Sections from root to tip.
    pub sections: Vec<Section>,
}

impl Wing {
    /// Reads a wing file.
    ///
    /// # Errors
    /// What is wrong in the file, fewer than two sections, chords that are not positive, sections that coincide.
    pub fn read(document: &Document) -> Result<Self, CaseError> {
        let file: WingFile = document.load()?;
        if file.section.len() < 2 {
            return Err(document.error(
                "section",
                "one section: needed two or more",
                "add a [[section]] for the tip",
            ));
        }
        let mut sections: Vec<Section> = Vec::new();
        for (i, s) in file.section.iter().enumerate() {
            if s.chord.0 <= 0.0 {
                let key = format!("section.{i}.chord");
                let message = format!("chord {} m: needed a positive length", s.chord.0);
                return Err(document.error(&key, message, "for a pointed tip give a small chord"));
            }
            let le = s.leading_edge.map(|l| l.0);
            if let Some(last) = sections.last() {
                let span = (le[1] - last.leading_edge_m[1]).hypot(le[2] - last.leading_edge_m[2]);
                if span <= 0.0 {
                    let key = format!("section.{i}.leading_edge");
                    return Err(document.error(
                        &key,
                        "same span station as the section before",
                        "order them root to tip",
                    ));
                }
            }
            let airfoil = match &s.airfoil {
                Some(path) => Some(Airfoil::read(&document.path(path))?),
                None => None,
            };
            let twist_rad = s.twist.map_or(0.0, |t| t.0);
            sections.push(Section {
                leading_edge_m: le,
                chord_m: s.chord.0,
                twist_rad,
                airfoil,
            });
        }
        Ok(Self {
            name: file.name,
            sections,
        })
    }

    /// Planform area in the plane of the panels, m^2.
    pub fn area_m2(&self) -> f64 {
        let strip = |w: &[Section]| {
            let [a, b] = [&w[0], &w[1]];
            let span = (b.leading_edge_m[1] - a.leading_edge_m[1]).hypot(b.leading_edge_m[2] - a.leading_edge_m[2]);
            0.5 * (a.chord_m + b.chord_m) * span
        };
        self.sections.windows(2).map(strip).sum()
    }

    /// Half the chord of the first section, m.
    pub fn root_semichord_m(&self) -> f64 {
        0.5 * self.sections[0].chord_m
    }
}
