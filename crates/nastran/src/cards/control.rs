//! What is to be computed: EIGR, EIGRL, MKAERO1, MKAERO2, FLUTTER, FLFACT, TABDMP1, PARAM.

use crate::{
    error::{DeckError, FieldError, Location},
    fields::Card,
};

type Result<T> = std::result::Result<T, DeckError>;

/// How modes are normalized.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normalization {
    /// Unit generalized mass.
    Mass,
    /// Largest component of the analysis set is one.
    Max,
    /// This component of this point is one.
    Point(crate::fields::Dof),
}

/// A request for normal modes (EIGR, EIGRL).
#[derive(Debug, Clone)]
pub struct ModesRequest {
    /// Its number, selected by METHOD.
    pub id: u32,
    /// The method's name: LAN for EIGRL; all give the same modes here.
    pub method: String,
    /// Frequency range in Hz; none is open.
    pub range_hz: [Option<f64>; 2],
    /// Number of modes wanted; none is all in the range.
    pub count: Option<usize>,
    /// Normalization.
    pub normalization: Normalization,
    /// Where it stands.
    pub at: Location,
}

impl ModesRequest {
    /// `EIGR SID METHOD F1 F2 NE ND . . / NORM G C`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_eigr(card: &Card) -> Result<Self> {
        let normalization = match card.text(8) {
            "" | "MASS" => Normalization::Mass,
            "MAX" => Normalization::Max,
            "POINT" => Normalization::Point(crate::fields::Dof {
                point: card.id(9, "G")?,
                component: card.component(10, "C")?,
            }),
            _ => return Err(card.wrong(8, "NORM", "MASS, MAX or POINT", "")),
        };
        let method = card.text(1);
        const METHODS: [&str; 14] = [
            "", "LAN", "AHOU", "INV", "SINV", "GIV", "MGIV", "HOU", "MHOU", "AGIV", "UGIV", "DET", "SDET", "FEER",
        ];
        if !METHODS.contains(&method) {
            return Err(card.wrong(1, "METHOD", "one of LAN, AHOU, INV, SINV, GIV, MGIV, HOU, MHOU", ""));
        }
        let range = [card.real_opt(2, "F1")?, card.real_opt(3, "F2")?];
        let count = card.id_opt(5, "ND")?.map(|n| n as usize);
        Ok(Self {
            id: card.id(0, "SID")?,
            method: if method.is_empty() {
                "LAN".to_owned()
            } else {
                method.to_owned()
            },
            range_hz: range,
            count,
            normalization,
            at: card.at(),
        })
    }

    /// `EIGRL SID V1 V2 ND MSGLVL MAXSET SHFSCL NORM`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_eigrl(card: &Card) -> Result<Self> {
        let normalization = match card.text(7) {
            "" | "MASS" => Normalization::Mass,
            "MAX" => Normalization::Max,
            _ => return Err(card.wrong(7, "NORM", "MASS or MAX", "")),
        };
        Ok(Self {
            id: card.id(0, "SID")?,
            method: "LAN".to_owned(),
            range_hz: [card.real_opt(1, "V1")?, card.real_opt(2, "V2")?],
            count: card.id_opt(3, "ND")?.map(|n| n as usize),
            normalization,
            at: card.at(),
        })
    }
}

/// A pair of Mach number and reduced frequency at which aerodynamics are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachK {
    /// Mach number.
    pub mach: f64,
    /// Reduced frequency omega chord / (2 V).
    pub k: f64,
}

impl MachK {
    /// `MKAERO1 M1 ... M8 / K1 ... K8`: all combinations, the Mach number outermost
    ///
    /// # Errors
    /// Fields of the wrong kind, no Mach number or no reduced frequency, negative values.
    pub fn read_combinations(card: &Card) -> Result<Vec<Self>> {
        let mut list = Vec::new();
        for i in 0..8 {
            let Some(mach) = Self::value(card, i, "m")? else {
                continue;
            };
            for j in 8..16 {
                if let Some(k) = Self::value(card, j, "k")? {
                    list.push(Self { mach, k });
                }
            }
        }
        if list.is_empty() {
            return Err(
                card.error("needed at least one Mach number on the first line and one reduced frequency on the second")
            );
        }
        if card.len() > 16 {
            return Err(card.wrong(
                16,
                "k",
                "at most eight reduced frequencies",
                "put the others on another MKAERO1",
            ));
        }
        Ok(list)
    }

    /// `MKAERO2 M1 K1 M2 K2 ...`
    ///
    /// # Errors
    /// Fields of the wrong kind, a Mach number without reduced frequency, negative values.
    pub fn read_pairs(card: &Card) -> Result<Vec<Self>> {
        let mut list = Vec::new();
        for i in (0..card.len().max(1)).step_by(2) {
            match (Self::value(card, i, "m")?, Self::value(card, i + 1, "k")?) {
                (Some(mach), Some(k)) => list.push(Self { mach, k }),
                (None, None) if i > 0 => {}
                _ => return Err(card.wrong(i, "m, k", "a Mach number and a reduced frequency", "")),
            }
        }
        Ok(list)
    }

    fn value(card: &Card, index: usize, name: &str) -> Result<Option<f64>> {
        let value = card.real_opt(index, name)?;
        if value.is_some_and(|x| x < 0.0) {
            return Err(card.wrong(index, name, "a value that is not negative", ""));
        }
        Ok(value)
    }
}

/// Flutter methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlutterMethod {
    /// American method with complex eigenvectors.
    K,
    /// The same without viscous damping and without eigenvectors.
    Ke,
    /// British method, all combinations of density, Mach number and velocity.
    Pk,
    /// British method, the lists taken together point by point.
    PkNl,
}

/// How aerodynamics are interpolated in the K methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KInterpolation {
    /// Spline over reduced frequency at the nearest Mach number (L).
    Linear,
    /// Surface spline over Mach number and reduced frequency (S).
    Surface,
    /// PK methods: TCUB, cubic.
    Cubic,
}

/// A request for a flutter solution.
#[derive(Debug, Clone)]
pub struct Flutter {
    /// Its number, selected by FMETHOD.
    pub id: u32,
    /// Method.
    pub method: FlutterMethod,
    /// FLFACT lists: density ratios, Mach numbers, and reduced frequencies (K, KE) or velocities (PK, PKNL).
    pub lists: [u32; 3],
    /// Interpolation.
    pub interpolation: KInterpolation,
    /// Number of roots to print; none is all.
    pub roots: Option<usize>,
    /// Convergence of the reduced frequency in PK.
    pub epsilon: f64,
    /// Where it stands.
    pub at: Location,
}

impl Flutter {
    /// `FLUTTER SID METHOD DENS MACH RFREQ|VEL IMETH NVALUE EPS`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing; methods other than K, KE, PK and PKNL.
    pub fn read(card: &Card) -> Result<Self> {
        let method = match card.text(1) {
            "K" => FlutterMethod::K,
            "KE" => FlutterMethod::Ke,
            "PK" => FlutterMethod::Pk,
            "PKNL" => FlutterMethod::PkNl,
            "PKS" | "PKNLS" => {
                return Err(card.wrong(
                    1,
                    "METHOD",
                    "K, KE, PK or PKNL",
                    "PKS and PKNLS differ from PK and PKNL only in how they search",
                ));
            }
            _ => return Err(card.wrong(1, "METHOD", "K, KE, PK or PKNL", "")),
        };
        let interpolation = match card.text(5) {
            "" | "L" => KInterpolation::Linear,
            "S" => KInterpolation::Surface,
            "TCUB" => KInterpolation::Cubic,
            _ => return Err(card.wrong(5, "IMETH", "L, S or TCUB", "")),
        };
        // In MSC's PKNL and PKS the field of NVALUE may hold OMAX, a real; only a count is of use here.
        let roots = match crate::number::number(card.text(6)) {
            Some(crate::number::Number::Real(_)) => None,
            _ => card.id_opt(6, "NVALUE")?.map(|n| n as usize),
        };
        let epsilon = card.real_or(7, "EPS", 1e-3)?;
        Ok(Self {
            id: card.id(0, "SID")?,
            method,
            lists: [card.id(2, "DENS")?, card.id(3, "MACH")?, card.id(4, "RFREQ or VEL")?],
            interpolation,
            roots,
            epsilon: if epsilon > 0.0 { epsilon } else { 1e-3 },
            at: card.at(),
        })
    }
}

/// A list of factors (FLFACT).
#[derive(Debug, Clone)]
pub struct Factors {
    /// Its number.
    pub id: u32,
    /// The values. A negative velocity asks for eigenvectors there.
    pub values: Vec<f64>,
    /// Where it stands.
    pub at: Location,
}

impl Factors {
    /// `FLFACT SID F1 F2 ...` or `FLFACT SID F1 THRU FNF NF FMID`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let values = factors(card, 1)?;
        if values.is_empty() {
            return Err(card.wrong(1, "F1", "at least one value", ""));
        }
        Ok(Self {
            id: card.id(0, "SID")?,
            values,
            at: card.at(),
        })
    }
}

/// A list of reals, or `F1 THRU FNF NF FMID`:
/// `F_i = (F1 (FNF - FMID)(NF - i) + FNF (FMID - F1)(i - 1)) / ((FNF - FMID)(NF - i) + (FMID - F1)(i - 1))`,
/// which is evenly spaced when FMID is the mean of the ends (its default).
pub(crate) fn factors(card: &Card, index: usize) -> Result<Vec<f64>> {
    if card.text(index + 1) != "THRU" {
        return card.reals(index, "F");
    }
    let first = card.real(index, "F1")?;
    let last = card.real(index + 2, "FNF")?;
    let count = card.id(index + 3, "NF")?;
    if !(2..=100_000).contains(&count) {
        return Err(card.wrong(index + 3, "NF", "a number of values from 2 to 100000", ""));
    }
    let mid = card.real_or(index + 4, "FMID", 0.5 * (first + last))?;
    let (low, high) = (first.min(last), first.max(last));
    if !(low..=high).contains(&mid) || first == last {
        return Err(card.wrong(index + 4, "FMID", "a value between F1 and FNF", ""));
    }
    let n = f64::from(count);
    Ok((1..=count)
        .map(|i| {
            let (up, down) = (f64::from(i) - 1.0, n - f64::from(i));
            if i == 1 {
                first
            } else if i == count {
                last
            } else {
                (first * (last - mid) * down + last * (mid - first) * up) / ((last - mid) * down + (mid - first) * up)
            }
        })
        .collect())
}

/// What a damping table tabulates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DampingKind {
    /// Structural damping g.
    Structural,
    /// Fraction of critical damping, g / 2.
    Critical,
    /// Amplification factor Q = 1 / g.
    Quality,
}

/// Modal damping over frequency (TABDMP1).
#[derive(Debug, Clone)]
pub struct DampingTable {
    /// Its number, selected by SDAMPING.
    pub id: u32,
    /// What the values are.
    pub kind: DampingKind,
    /// Frequency in Hz and value, ascending in frequency.
    pub points: Vec<(f64, f64)>,
    /// Where it stands.
    pub at: Location,
}

impl DampingTable {
    /// `TABDMP1 TID TYPE / F1 G1 F2 G2 ... ENDT`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing; fewer than two points; frequencies that do not ascend; no ENDT.
    pub fn read(card: &Card) -> Result<Self> {
        let kind = match card.text(1) {
            "" | "G" => DampingKind::Structural,
            "CRIT" => DampingKind::Critical,
            "Q" => DampingKind::Quality,
            _ => return Err(card.wrong(1, "TYPE", "G, CRIT or Q", "")),
        };
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut i = 8;
        loop {
            if i >= card.len() {
                return Err(card.error("needed ENDT after the last pair"));
            }
            match card.text(i) {
                "ENDT" => break,
                "SKIP" => {}
                "" if !card.has(i + 1) => {}
                _ if card.text(i + 1) == "SKIP" => {}
                _ => {
                    let frequency = card.real(i, "f")?;
                    let value = card.real(i + 1, "g")?;
                    if points.last().is_some_and(|(f, _)| frequency < *f) {
                        return Err(card.wrong(i, "f", "frequencies that ascend", ""));
                    }
                    points.push((frequency, value));
                }
            }
            i += 2;
        }
        if points.len() < 2 {
            return Err(card.error("needed at least two pairs of frequency and damping"));
        }
        Ok(Self {
            id: card.id(0, "TID")?,
            kind,
            points,
            at: card.at(),
        })
    }

    /// Structural damping g at a frequency: linear between the points and beyond the ends along the end segments, the mean
    /// at a jump (Nastran's rule for TABDMP1).
    pub fn structural_damping(&self, freq_hz: f64) -> f64 {
        let p = &self.points;
        let hits: Vec<f64> = p.iter().filter(|(f, _)| *f == freq_hz).map(|(_, g)| *g).collect();
        let value = if hits.is_empty() {
            let above = p
                .iter()
                .position(|(f, _)| *f > freq_hz)
                .unwrap_or(p.len() - 1)
                .clamp(1, p.len() - 1);
            let ((f0, g0), (f1, g1)) = (p[above - 1], p[above]);
            if f1 == f0 {
                0.5 * (g0 + g1)
            } else {
                g0 + (g1 - g0) * (freq_hz - f0) / (f1 - f0)
            }
        } else {
            hits.iter().sum::<f64>() / hits.len() as f64
        };
        match self.kind {
            DampingKind::Structural => value,
            DampingKind::Critical => 2.0 * value,
            DampingKind::Quality => {
                if value == 0.0 {
                    0.0
                } else {
                    1.0 / value
                }
            }
        }
    }
}

/// A parameter: its value as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// Upper-case name.
    pub name: String,
    /// First value, upper-case.
    pub value: String,
    /// Where it stands.
    pub at: Location,
}

impl Parameter {
    /// `PARAM N V1 V2`
    ///
    /// # Errors
    /// No name or no value.
    pub fn read(card: &Card) -> Result<Self> {
        let Some(name) = card.word(0) else {
            return Err(card.wrong(0, "N", "the name of a parameter", ""));
        };
        let Some(value) = card.word(1) else {
            return Err(card.wrong(1, "V1", "a value", ""));
        };
        Ok(Self {
            name: name.to_owned(),
            value: value.to_owned(),
            at: card.at(),
        })
    }

    /// The value as a real.
    ///
    /// # Errors
    /// A value that is no number.
    pub fn real(&self) -> Result<f64> {
        crate::number::real(&self.value).ok_or_else(|| self.wrong("a number"))
    }

    /// The value as an integer.
    ///
    /// # Errors
    /// A value that is no integer.
    pub fn integer(&self) -> Result<i64> {
        match crate::number::number(&self.value) {
            Some(crate::number::Number::Integer(i)) => Ok(i),
            _ => Err(self.wrong("an integer")),
        }
    }

    fn wrong(&self, needed: &str) -> DeckError {
        DeckError::Field(Box::new(FieldError {
            at: self.at.clone(),
            card: format!("PARAM {}", self.name),
            field: 3,
            name: "V1".to_owned(),
            needed: needed.to_owned(),
            got: self.value.clone(),
            hint: String::new(),
        }))
    }
}
