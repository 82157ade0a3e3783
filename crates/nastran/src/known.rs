//! Names of cards and parameters: which are read, which change nothing here, which cannot be used and what to write instead.

/// Cards without effect on modes or flutter: loads, responses, optimization, static aeroelasticity, output.
const WITHOUT_EFFECT: &[&str] = &[
    "FORCE", "FORCE1", "FORCE2", "MOMENT", "MOMENT1", "MOMENT2", "PLOAD", "PLOAD1", "PLOAD2", "PLOAD4", "LOAD", "GRAV",
    "ACCEL", "ACCEL1", "RFORCE", "TEMP", "TEMPD", "TEMPP1", "TEMPRB", "SLOAD", "SPCD", "LSEQ", "TLOAD1", "TLOAD2",
    "RLOAD1", "RLOAD2", "DLOAD", "DAREA", "DELAY", "DPHASE", "GUST", "RANDPS", "RANDT1", "TABRND1", "TABRNDG",
    "TABLED1", "TABLED2", "TABLED3", "TABLED4", "TABLEM1", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5",
    "TSTEP", "TSTEPNL", "TIC", "EIGC", "EIGP", "EIGB", "TRIM", "TRIM2", "AESTAT", "AELINK", "AEPARM", "AEFORCE",
    "AEPRESS", "AECOMP", "AECOMPL", "CSSCHD", "DIVERG", "MONPNT1", "MONPNT2", "MONPNT3", "MONDSP1", "MONSUM", "UXVEC",
    "AEDW", "AESCALE", "PLOTEL", "DESVAR", "DVPREL1", "DVPREL2", "DVMREL1", "DVCREL1", "DRESP1", "DRESP2", "DRESP3",
    "DCONSTR", "DCONADD", "DEQATN", "DOPTPRM", "DLINK", "DTABLE", "DSCREEN", "MDLPRM", "BSURF", "BSURFS", "BCTABLE",
    "NLPARM", "DTI", "VIEW", "VIEW3D", "RADM", "CORDM", "SWLDPRM", "MATT1", "MATT8", "MATS1", "CREEP", "SET3",
    "TOPVAR",
];

/// Parameters that change a flutter solution; all others are noted as without effect.
const USED_PARAMETERS: &[&str] = &[
    "COUPMASS", "WTMASS", "LMODES", "LFREQ", "HFREQ", "VREF", "KDAMP", "G", "W3", "AUTOSPC", "K6ROT",
];

/// Cards that change the model, with what to do instead.
const UNSUPPORTED: &[(&str, &str)] = &[
    ("CBUSH", "use CELAS1 or CELAS2"),
    ("PBUSH", "use PELAS"),
    ("CBEND", "use CBARs along the arc"),
    ("CTUBE", "use CROD with PROD"),
    ("PTUBE", "use PROD"),
    ("CSHEAR", "use CQUAD4 with a membrane material"),
    ("PSHEAR", "use PSHELL"),
    ("PCOMPG", "give membrane and bending matrices by PSHELL with MAT2"),
    ("CQUAD8", "use CQUAD4"),
    ("CTRIA6", "use CTRIA3"),
    ("CQUADR", "use CQUAD4"),
    ("CTRIAR", "use CTRIA3"),
    ("CHEXA", "give the structure's modes in a mode file instead"),
    ("CPENTA", "give the structure's modes in a mode file instead"),
    ("CTETRA", "give the structure's modes in a mode file instead"),
    ("CPYRAM", "give the structure's modes in a mode file instead"),
    ("PSOLID", "give the structure's modes in a mode file instead"),
    ("PBEAML", "give the section's area and moments on PBEAM or PBAR"),
    ("PBCOMP", "give the section's area and moments on PBEAM or PBAR"),
    ("RBE1", "use RBE2 or MPC"),
    ("RROD", "use RBAR or MPC"),
    ("RTRPLT", "use RBE2"),
    ("RSPLINE", "use RBE3 or MPC"),
    ("RJOINT", "use MPC"),
    (
        "CAERO3",
        "supersonic panels are not computed; Mach numbers must be below one",
    ),
    (
        "CAERO5",
        "piston theory is not computed; Mach numbers must be below one",
    ),
    ("PAERO3", "supersonic panels are not computed"),
    ("PAERO5", "piston theory is not computed"),
    ("CAERO7", "this is a ZAERO card; use CAERO1"),
    (
        "PAERO2",
        "slender bodies are not computed; model the body by crossed CAERO1 panels or leave it out",
    ),
    ("SPLINE3", "use SPLINE1 or SPLINE2"),
    ("SPLINE6", "use SPLINE1 or SPLINE4"),
    ("SPLINE7", "use SPLINE2 or SPLINE5"),
    ("SPLINEX", "use SPLINE1 or SPLINE2"),
    ("SPLINRB", "use SPLINE1 or SPLINE2"),
    ("SET2", "list the points on SET1"),
    ("BSET", "use ASET"),
    ("BSET1", "use ASET1"),
    ("CSET", "use ASET"),
    ("CSET1", "use ASET1"),
    ("QSET", "component modes are not computed"),
    ("QSET1", "component modes are not computed"),
    ("SESET", "superelements are not computed"),
    ("EPOINT", "extra points are not used in flutter here"),
    ("TF", "transfer functions are not used in flutter here"),
    ("DMIAX", "use DMIG"),
    ("NSM", "use the NSM field of the property"),
    ("NSM1", "use the NSM field of the property"),
    ("NSML", "use the NSM field of the property"),
    ("NSML1", "use the NSM field of the property"),
    ("NSMADD", "use the NSM field of the property"),
    ("MAT3", "use MAT1 or MAT8"),
    ("MAT9", "use MAT1 or MAT8"),
    ("CVISC", "use CDAMP2"),
    ("CDAMP5", "use CDAMP2"),
];

/// Whether an unsupported card belongs to the structure (and is not simply unknown).
pub fn is_structural(name: &str) -> bool {
    let known = READ.contains(&name) || UNSUPPORTED.iter().any(|(n, _)| *n == name);
    known
        && !["CAERO", "PAERO", "SPL", "SET", "AE"]
            .iter()
            .any(|aero| name.starts_with(aero))
}

/// Names that are read; used for the nearest-name hint.
const READ: &[&str] = &[
    "GRID", "GRDSET", "SPOINT", "CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S", "MAT1", "MAT2", "MAT8",
    "PBAR", "PBARL", "PBEAM", "PROD", "PSHELL", "PCOMP", "PELAS", "PMASS", "PDAMP", "BAROR", "BEAMOR", "CBAR", "CBEAM",
    "CROD", "CONROD", "CQUAD4", "CTRIA3", "CELAS1", "CELAS2", "CELAS3", "CELAS4", "CMASS1", "CMASS2", "CMASS3",
    "CMASS4", "CDAMP1", "CDAMP2", "CDAMP3", "CDAMP4", "GENEL", "CONM1", "CONM2", "RBE2", "RBAR", "RBE3", "MPC",
    "MPCADD", "SPC", "SPC1", "SPCADD", "ASET", "ASET1", "OMIT", "OMIT1", "SUPORT", "SUPORT1", "EIGR", "EIGRL", "AERO",
    "AEROS", "CAERO1", "CAERO2", "CAERO4", "PAERO1", "PAERO4", "AEFACT", "AELIST", "AESURF", "SET1", "SPLINE1",
    "SPLINE2", "SPLINE4", "SPLINE5", "MKAERO1", "MKAERO2", "FLUTTER", "FLFACT", "TABDMP1", "PARAM", "DMI", "DMIG",
];

/// Whether a card changes neither modes nor flutter.
pub fn is_without_effect(name: &str) -> bool {
    WITHOUT_EFFECT.contains(&name)
}

/// Why a card cannot be used, and what to write instead.
pub fn why_not(name: &str) -> String {
    match UNSUPPORTED.iter().find(|(n, _)| *n == name) {
        Some((_, hint)) => (*hint).to_owned(),
        None => match nearest(name) {
            Some(near) => format!("no such card is known; did you mean {near}?"),
            None => "no such card is known; remove it if it does not change the model".to_owned(),
        },
    }
}

/// Whether a solution of the deck depends on the parameter.
pub fn is_used_parameter(name: &str) -> bool {
    USED_PARAMETERS.contains(&name)
}

/// The known name that differs by at most two letters.
fn nearest(name: &str) -> Option<&'static str> {
    READ.iter()
        .map(|known| (distance(name, known), *known))
        .filter(|(d, _)| *d <= 2)
        .min()
        .map(|(_, known)| known)
}

/// Levenshtein's distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let up = row[j + 1];
            row[j + 1] = (diagonal + usize::from(ca != *cb)).min(up + 1).min(row[j] + 1);
            diagonal = up;
        }
    }
    row[b.len()]
}
