//! The results as text, in the layout of Nastran's print file.

use std::fmt::{self, Write};

use dip_dlm::lattice::PlaneSymmetry;
use dip_flutter::{CrossingKind, Direction};
use dip_modal::Modes;
use dip_nastran::cards::control::FlutterMethod;

use crate::{
    aerodynamics::GeneralizedForces,
    flutter::{Crossing, Summary},
};

/// A number as Fortran's 1PE format writes it: `-1.2345678E+03`.
fn exponent(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return format!("{value}");
    }
    let text = format!("{value:.digits$E}");
    match text.split_once('E') {
        Some((mantissa, power)) => {
            let (sign, power) = match power.strip_prefix('-') {
                Some(rest) => ('-', rest),
                None => ('+', power),
            };
            format!("{mantissa}E{sign}{power:0>2}")
        }
        None => text,
    }
}

/// Name of a method on a FLUTTER card.
pub fn method_name(method: FlutterMethod) -> &'static str {
    match method {
        FlutterMethod::K => "K",
        FlutterMethod::Ke => "KE",
        FlutterMethod::Pk => "PK",
        FlutterMethod::PkNl => "PKNL",
    }
}

fn symmetry_name(symmetry: PlaneSymmetry) -> &'static str {
    match symmetry {
        PlaneSymmetry::None => "ASYMMETRIC",
        PlaneSymmetry::Symmetric => "SYMMETRIC",
        PlaneSymmetry::Antisymmetric => "ANTISYMMETRIC",
    }
}

/// The table REAL EIGENVALUES.
///
/// # Errors
/// Those of the writer.
pub fn eigenvalues(out: &mut impl Write, modes: &Modes) -> fmt::Result {
    writeln!(out, "{:46}R E A L   E I G E N V A L U E S", "")?;
    writeln!(
        out,
        "   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            GENERALIZED         GENERALIZED"
    )?;
    writeln!(out, "    NO.       ORDER{:72}MASS              STIFFNESS", "")?;
    for mode in 0..modes.count() {
        let omega = modes.omega_rad_s[mode];
        write!(out, "{:9}{:10}", mode + 1, mode + 1)?;
        let values = [
            omega * omega,
            omega,
            modes.freq_hz(mode),
            modes.generalized_mass[mode],
            modes.generalized_stiffness(mode),
        ];
        for value in values {
            write!(out, "{:>20}", exponent(value, 6))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The flutter summary, one block a point.
///
/// # Errors
/// Those of the writer.
pub fn summary(out: &mut impl Write, summary: &Summary, symmetry: [PlaneSymmetry; 2]) -> fmt::Result {
    for point in &summary.points {
        writeln!(out, "0{:55}FLUTTER  SUMMARY", "")?;
        writeln!(
            out,
            "{:25}CONFIGURATION = AEROSG2D     XY-SYMMETRY = {}     XZ-SYMMETRY = {}",
            "",
            symmetry_name(symmetry[1]),
            symmetry_name(symmetry[0])
        )?;
        let matched = summary.method == FlutterMethod::PkNl;
        if matched {
            writeln!(out, "       POINT = {:4}     METHOD = PKNL", point.number)?;
        } else {
            writeln!(
                out,
                "       POINT = {:4}     MACH NUMBER = {:7.4}     DENSITY RATIO = {:>11}     METHOD = {}",
                point.number,
                summary.mach,
                exponent(summary.density_ratio, 4),
                method_name(summary.method)
            )?;
        }
        writeln!(out)?;
        writeln!(out)?;
        write!(out, "       KFREQ            1./KFREQ         ")?;
        if matched {
            write!(out, "DENSITY         MACH NO.          ")?;
        }
        writeln!(
            out,
            "VELOCITY            DAMPING         FREQUENCY            COMPLEX   EIGENVALUE"
        )?;
        for row in &point.rows {
            let inverse = if row.k > 1e-25 { 1.0 / row.k } else { 1e25 };
            write!(out, "{:14.4}{:>20}", row.k, exponent(inverse, 7))?;
            if matched {
                write!(
                    out,
                    "{:>18}{:>18}",
                    exponent(row.density_ratio, 7),
                    exponent(row.mach, 7)
                )?;
            }
            for value in [
                row.velocity,
                row.damping,
                row.freq_hz,
                row.eigenvalue.re,
                row.eigenvalue.im,
            ] {
                write!(out, "{:>18}", exponent(value, 7))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The crossings of a summary, one line each.
///
/// # Errors
/// Those of the writer.
pub fn crossings(out: &mut impl Write, crossings: &[Crossing]) -> fmt::Result {
    for c in crossings {
        let kind = match c.kind {
            CrossingKind::Flutter => "flutter",
            CrossingKind::Divergence => "divergence",
        };
        let direction = match c.direction {
            Direction::Onset => "onset",
            Direction::Recovery => "end",
        };
        let how = if c.is_interpolated { " (interpolated)" } else { "" };
        writeln!(
            out,
            "{kind} {direction}: mode {}, velocity {:.6}, frequency {:.6} Hz, k {:.6}, Mach {:.4}, density ratio {:.6}{how}",
            c.mode, c.velocity, c.freq_hz, c.k, c.mach, c.density_ratio
        )?;
    }
    Ok(())
}

/// The generalized forces QHH, row by row.
///
/// # Errors
/// Those of the writer.
pub fn generalized_forces(out: &mut impl Write, forces: &[GeneralizedForces]) -> fmt::Result {
    for entry in forces {
        writeln!(out, "QHH   MACH NUMBER = {:.4}   KFREQ = {:.6}", entry.mach, entry.k)?;
        for row in 0..entry.q.rows() {
            for column in 0..entry.q.columns() {
                let value = entry.q[(row, column)];
                write!(out, " ({:>15},{:>15})", exponent(value.re, 7), exponent(value.im, 7))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::exponent;

    #[test]
    fn exponents_look_like_fortrans() {
        assert_eq!(exponent(4774.2998, 7), "4.7742998E+03");
        assert_eq!(exponent(-0.0, 7), "-0.0000000E+00");
        assert_eq!(exponent(1e25, 7), "1.0000000E+25");
        assert_eq!(exponent(-6.0e-2, 4), "-6.0000E-02");
    }
}
