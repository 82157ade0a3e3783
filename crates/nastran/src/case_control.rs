//! Executive and case control: which solution, which sets, with the inheritance of subcases.

use std::collections::BTreeMap;

use crate::{
    cards::control::Parameter,
    error::{DeckError, Location, Note, Severity},
    source::Line,
};

/// A statement of the case control section.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    /// The part behind the equals sign, or behind the name where there is none.
    pub value: String,
    /// What stands in parentheses behind the name.
    pub options: String,
    /// Where it stands.
    pub at: Location,
}

impl Setting {
    /// The value as the number of a set; zero and NONE are none.
    ///
    /// # Errors
    /// Text that is no number.
    pub fn id(&self, name: &str) -> Result<Option<u32>, DeckError> {
        if self.value.eq_ignore_ascii_case("NONE") {
            return Ok(None);
        }
        match self.value.parse::<u32>() {
            Ok(0) => Ok(None),
            Ok(id) => Ok(Some(id)),
            Err(_) => Err(DeckError::Control {
                at: self.at.clone(),
                what: format!("{name}: needed the number of a set, got \"{}\"", self.value),
            }),
        }
    }
}

/// A subcase with everything it inherits from above the subcases.
#[derive(Debug, Clone, Default)]
pub struct Subcase {
    /// Its number; 0 if the deck has no SUBCASE statement.
    pub id: u32,
    /// Its statements by full name.
    pub settings: BTreeMap<String, Setting>,
}

impl Subcase {
    /// The number of the set that a statement selects.
    ///
    /// # Errors
    /// A value that is no number.
    pub fn set(&self, name: &str) -> Result<Option<u32>, DeckError> {
        match self.settings.get(name) {
            Some(setting) => setting.id(name),
            None => Ok(None),
        }
    }

    /// The text of a statement, for example of TITLE.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.settings.get(name).map(|s| s.value.as_str())
    }
}

/// Everything before the bulk data.
#[derive(Debug, Clone, Default)]
pub struct Control {
    /// The solution's number (145 for flutter) and where it is asked for.
    pub solution: Option<(u32, Location)>,
    /// The subcases in order; one without number if the deck has none.
    pub subcases: Vec<Subcase>,
    /// Parameters given in the case control section.
    pub parameters: Vec<Parameter>,
}

/// Statements that select something that modes or flutter depend on.
const SELECTORS: &[&str] = &[
    "METHOD", "FMETHOD", "SPC", "MPC", "SDAMPING", "SUPORT1", "K2GG", "M2GG", "B2GG", "AESYMXZ", "AESYMXY", "RESVEC",
];
const TITLES: &[&str] = &["TITLE", "SUBTITLE", "LABEL"];
/// Statements that change the model in ways this program cannot follow.
const REFUSED: &[(&str, &str)] = &[
    ("K2PP", "direct matrices after constraint; use K2GG"),
    ("M2PP", "direct matrices after constraint; use M2GG"),
    ("B2PP", "direct matrices after constraint; use B2GG"),
    ("TFL", "transfer functions"),
    ("K42GG", "direct structural damping"),
    ("NSM", "nonstructural mass sets"),
];
/// Output requests and statements without effect on the solution.
const WITHOUT_EFFECT: &[&str] = &[
    "ECHO",
    "DISPLACEMENT",
    "SVECTOR",
    "SDISPLACEMENT",
    "SPCFORCES",
    "MPCFORCES",
    "STRESS",
    "STRAIN",
    "FORCE",
    "ELFORCE",
    "ELSTRESS",
    "OLOAD",
    "ESE",
    "EKE",
    "EDE",
    "GPFORCE",
    "GPSTRESS",
    "GPSTRAIN",
    "AEROF",
    "APRES",
    "VELOCITY",
    "SVELOCITY",
    "ACCELERATION",
    "SACCELERATION",
    "VECTOR",
    "SEALL",
    "SUPER",
    "SEDR",
    "SEID",
    "SEKR",
    "SEMG",
    "SEMR",
    "SELG",
    "SELR",
    "LINE",
    "MAXLINES",
    "PAGE",
    "SET",
    "SETP",
    "CMETHOD",
    "MODES",
    "HARMONICS",
    "MEFFMASS",
    "GROUNDCHECK",
    "WEIGHTCHECK",
    "AECONFIG",
    "TRIM",
    "DIVERG",
    "GUST",
    "DLOAD",
    "FREQUENCY",
    "RANDOM",
    "TSTEP",
    "LOAD",
    "TEMPERATURE",
    "DEFORM",
    "LOADSET",
    "NLPARM",
    "IC",
    "ANALYSIS",
    "DESOBJ",
    "DESSUB",
    "DESGLB",
    "FLSFSEL",
    "MONITOR",
    "OMODES",
    "POST",
    "PARTN",
    "ELSUM",
    "NCHECK",
    "OTIME",
    "OFREQUENCY",
    "ADAMSMNF",
    "MCFRACTION",
    "GPKE",
    "EXTSEOUT",
    "SDENSITY",
    "SENSITY",
    "AUXMODEL",
    "RIGID",
    "STATSUB",
    "BCID",
    "SKIP",
    "FLUX",
    "THERMAL",
    "ENTHALPY",
    "TITLES",
    "NOUTPUT",
    "VUGRID",
    "DATAREC",
    "RGYRO",
    "SMETHOD",
];

/// Splits the lines of a deck into control sections and bulk data.
///
/// # Errors
/// Statements that cannot be read; all of them.
pub fn split(lines: &[Line], notes: &mut Vec<Note>) -> Result<(Control, Vec<Line>), Vec<DeckError>> {
    let upper: Vec<String> = lines.iter().map(|l| l.text.trim().to_uppercase()).collect();
    let cend = upper.iter().position(|l| l == "CEND");
    let begin = upper.iter().position(|l| begins_bulk(l));
    let mut control = Control::default();
    let mut errors = Vec::new();
    let (bulk_from, control_to) = match begin {
        Some(i) => (i + 1, i),
        // A deck without control sections is bulk data alone, as INCLUDE files and punched models are.
        None if cend.is_none() => (0, 0),
        None => {
            return Err(vec![DeckError::Control {
                at: lines[cend.unwrap_or(0)].at.clone(),
                what: "needed BEGIN BULK somewhere after CEND, got the end of the deck".to_owned(),
            }]);
        }
    };
    let case_from = match cend {
        Some(c) if c < control_to => {
            executive(&lines[..c], &mut control, notes);
            c + 1
        }
        // Without CEND the executive statements, if any, stand in front of the first case control statement.
        _ => {
            let first_case = (0..control_to)
                .find(|i| !is_executive(&upper[*i]))
                .unwrap_or(control_to);
            executive(&lines[..first_case], &mut control, notes);
            first_case
        }
    };
    case(&lines[case_from..control_to], &mut control, notes, &mut errors);
    let end = upper
        .iter()
        .skip(bulk_from)
        .position(|l| l.starts_with("ENDDATA"))
        .map_or(lines.len(), |i| i + bulk_from);
    if errors.is_empty() {
        Ok((control, lines[bulk_from..end].to_vec()))
    } else {
        Err(errors)
    }
}

fn begins_bulk(line: &str) -> bool {
    let mut words = line.split_whitespace();
    words.next() == Some("BEGIN") && words.next().is_none_or(|w| w.starts_with("BULK") || w == "=")
}

fn is_executive(line: &str) -> bool {
    [
        "SOL",
        "ID",
        "TIME",
        "DIAG",
        "APP",
        "NASTRAN",
        "ASSIGN",
        "CHKPNT",
        "GEOMCHECK",
        "INIT",
        "COMPILE",
        "ALTER",
        "ENDALTER",
    ]
    .iter()
    .any(|w| line.split([' ', ',', '=']).next() == Some(w))
}

fn executive(lines: &[Line], control: &mut Control, notes: &mut Vec<Note>) {
    for line in lines {
        let text = line.text.trim().to_uppercase();
        let mut words = text.split([' ', ',', '=']).filter(|w| !w.is_empty());
        match words.next() {
            Some("SOL") => {
                let number = words.next().and_then(|w| match w {
                    "SEFLUTR" | "SEFLUTTR" | "FLUTTER" => Some(145),
                    "SEMODES" => Some(103),
                    w => w.parse().ok(),
                });
                match number {
                    Some(n) => control.solution = Some((n, line.at.clone())),
                    None => notes.push(Note {
                        at: line.at.clone(),
                        card: "SOL".to_owned(),
                        severity: Severity::Warning,
                        text: format!("\"{text}\" names no solution that is known; flutter (145) is taken"),
                    }),
                }
            }
            Some("COMPILE" | "ALTER") => notes.push(Note {
                at: line.at.clone(),
                card: "ALTER".to_owned(),
                severity: Severity::Warning,
                text: "changes to the solution sequence (DMAP) are not followed".to_owned(),
            }),
            _ => {}
        }
    }
}

/// Reads the case control section: name, options in parentheses, value; lines that end in a comma go on below.
fn case(lines: &[Line], control: &mut Control, notes: &mut Vec<Note>, errors: &mut Vec<DeckError>) {
    let mut above = Subcase::default();
    let mut subcases: Vec<Subcase> = Vec::new();
    let mut plotting: Option<&Location> = None;
    let mut i = 0;
    while i < lines.len() {
        let line = &lines[i];
        let mut text = line.text.trim().to_owned();
        i += 1;
        while text.ends_with(',') && i < lines.len() {
            text.push_str(lines[i].text.trim());
            i += 1;
        }
        let (name, options, value) = statement(&text);
        if name == "OUTPUT" {
            plotting = (!options.is_empty()).then_some(&line.at);
            if plotting.is_some() {
                notes.push(Note {
                    at: line.at.clone(),
                    card: format!("OUTPUT({options})"),
                    severity: Severity::Ignored,
                    text: "plot requests are not followed".to_owned(),
                });
            }
            continue;
        }
        if plotting.is_some() && name != "SUBCASE" {
            continue;
        }
        plotting = None;
        let full = full_name(&name);
        let setting = Setting {
            value,
            options,
            at: line.at.clone(),
        };
        match full {
            Some("SUBCASE") => match setting.value.split_whitespace().next().unwrap_or("").parse() {
                Ok(id) => subcases.push(Subcase {
                    id,
                    settings: above.settings.clone(),
                }),
                Err(_) => errors.push(DeckError::Control {
                    at: setting.at,
                    what: format!("SUBCASE: needed a number, got \"{}\"", setting.value),
                }),
            },
            Some(full) if SELECTORS.contains(&full) || TITLES.contains(&full) => {
                let into = subcases.last_mut().unwrap_or(&mut above);
                into.settings.insert(full.to_owned(), setting);
            }
            Some("PARAM") => {
                let mut words = text
                    .split([',', '=', ' '])
                    .filter(|w| !w.is_empty())
                    .skip(1)
                    .map(str::to_uppercase);
                match (words.next(), words.next()) {
                    (Some(name), Some(value)) => control.parameters.push(Parameter {
                        name,
                        value,
                        at: setting.at,
                    }),
                    _ => errors.push(DeckError::Control {
                        at: setting.at,
                        what: "PARAM: needed a name and a value, as in PARAM,VREF,12.".to_owned(),
                    }),
                }
            }
            Some(full) if REFUSED.iter().any(|(n, _)| *n == full) => {
                let what = REFUSED.iter().find(|(n, _)| *n == full).map_or("", |(_, w)| w);
                errors.push(DeckError::Unsupported {
                    at: setting.at,
                    card: full.to_owned(),
                    hint: what.to_owned(),
                });
            }
            Some(_) => {}
            None => notes.push(Note {
                at: setting.at,
                card: name,
                severity: Severity::Warning,
                text: "this case control statement is not known and not followed".to_owned(),
            }),
        }
    }
    if subcases.is_empty() {
        subcases.push(above);
    }
    control.subcases = subcases;
}

/// `NAME(OPTIONS) = VALUE`; the equals sign may be missing (`SUBCASE 1`).
fn statement(text: &str) -> (String, String, String) {
    let end = text.find([' ', '(', '=', ',']).unwrap_or(text.len());
    let name = text[..end].to_uppercase();
    let mut rest = text[end..].trim_start();
    let mut options = String::new();
    if let Some(inside) = rest.strip_prefix('(') {
        let close = inside.find(')').unwrap_or(inside.len());
        options = inside[..close].trim().to_uppercase();
        rest = inside.get(close + 1..).unwrap_or("").trim_start();
    }
    let rest = rest.trim_start_matches('=').trim();
    (name, options, rest.to_owned())
}

/// Statements may be cut to their first four letters.
fn full_name(name: &str) -> Option<&'static str> {
    let all = || {
        SELECTORS
            .iter()
            .chain(TITLES)
            .chain(WITHOUT_EFFECT)
            .chain(&["SUBCASE", "PARAM", "SUBCOM", "SUBSEQ", "SYM", "SYMCOM", "REPCASE"])
            .chain(REFUSED.iter().map(|(n, _)| n))
            .copied()
    };
    all().find(|full| *full == name).or_else(|| {
        (name.len() >= 4)
            .then(|| all().find(|full| full.starts_with(name)))
            .flatten()
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::source::lines_of_text;

    fn read(text: &str) -> (Control, Vec<Line>, Vec<Note>) {
        let mut notes = Vec::new();
        let (control, bulk) = split(&lines_of_text(text, "deck", Path::new(".")).unwrap(), &mut notes).unwrap();
        (control, bulk, notes)
    }

    #[test]
    fn subcases_inherit_and_override() {
        let (control, bulk, _) = read(
            "ID A,B\nSOL 145\nCEND\nTITLE = x\nSUBTI = y\nMETHOD = 1\nDISP(plot) = ALL\nSUBCASE 1\n FMETHOD = 3\nSUBCASE 2\n FMETHOD = 4\n METHOD = 7\nBEGIN BULK\nGRID,1\nENDDATA\nGRID,2\n",
        );
        assert_eq!(control.solution.as_ref().unwrap().0, 145);
        let sets: Vec<_> = control
            .subcases
            .iter()
            .map(|s| (s.id, s.set("METHOD").unwrap(), s.set("FMETHOD").unwrap()))
            .collect();
        assert_eq!(sets, [(1, Some(1), Some(3)), (2, Some(7), Some(4))]);
        assert_eq!(control.subcases[1].text("SUBTITLE"), Some("y"));
        assert_eq!(bulk.len(), 1);
    }

    #[test]
    fn plot_sections_are_passed_over_with_a_note() {
        let (control, _, notes) = read(
            "SOL 145\nCEND\nSPC=1\nOUTPUT(PLOT)\nSET 1 = AERO1\nSPC = 99\nOUTPUT (XYOUT)\nXYPLOT VG / 1(G,F)\nBEGIN BULK\n",
        );
        assert_eq!(control.subcases[0].set("SPC").unwrap(), Some(1));
        assert_eq!(notes.len(), 2);
    }

    #[test]
    fn parameters_may_stand_in_the_case_control_section() {
        let (control, _, notes) = read("SOL 145\nCEND\nPARAM,VREF,12.\nBEGIN BULK\n");
        assert_eq!(
            (
                control.parameters[0].name.as_str(),
                control.parameters[0].value.as_str()
            ),
            ("VREF", "12.")
        );
        assert!(notes.is_empty());
    }

    #[test]
    fn bulk_data_alone_is_a_deck() {
        let (control, bulk, _) = read("GRID,1\nGRID,2\n");
        assert_eq!((control.subcases.len(), bulk.len()), (1, 2));
    }
}
