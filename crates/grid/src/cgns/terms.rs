//! Words and index rules of CGNS, and ours.

use crate::face::{Face, Window};
use crate::topology::{Condition, Orientation, Side};

/// The SIDS name of a condition (SIDS, `BCType_t`).
pub(super) fn bc_type(condition: Condition) -> &'static str {
    match condition {
        Condition::Wall => "BCWall",
        Condition::WallSlip => "BCWallInviscid",
        Condition::WallNoSlip => "BCWallViscous",
        Condition::Symmetry => "BCSymmetryPlane",
        Condition::FarField => "BCFarfield",
        Condition::InflowSubsonic => "BCInflowSubsonic",
        Condition::InflowSupersonic => "BCInflowSupersonic",
        Condition::OutflowSubsonic => "BCOutflowSubsonic",
        Condition::OutflowSupersonic => "BCOutflowSupersonic",
        Condition::Collapsed => "BCDegenerateLine",
    }
}

/// The condition of a SIDS name; `None` for those that say nothing (`Null`, `UserDefined`, `FamilySpecified`, ...).
pub(super) fn condition(bc_type: &str) -> Option<Condition> {
    Some(match bc_type {
        "BCWall" => Condition::Wall,
        "BCWallInviscid" => Condition::WallSlip,
        "BCWallViscous" | "BCWallViscousHeatFlux" | "BCWallViscousIsothermal" => Condition::WallNoSlip,
        "BCSymmetryPlane" => Condition::Symmetry,
        "BCFarfield" => Condition::FarField,
        "BCInflow" | "BCInflowSubsonic" | "BCTunnelInflow" => Condition::InflowSubsonic,
        "BCInflowSupersonic" => Condition::InflowSupersonic,
        "BCOutflow" | "BCOutflowSubsonic" | "BCTunnelOutflow" => Condition::OutflowSubsonic,
        "BCOutflowSupersonic" | "BCExtrapolate" => Condition::OutflowSupersonic,
        "BCDegenerateLine" | "BCDegeneratePoint" | "BCSymmetryPolar" | "BCAxisymmetricWedge" => Condition::Collapsed,
        _ => return None,
    })
}

/// A range of nodes as CGNS has it: begin and end, from 1.
pub(super) type Range = [[i64; 3]; 2];

/// The window that a range of nodes covers on a face of a block of `cells`, or why there is none.
pub(super) fn side(block: usize, cells: [usize; 3], range: Range) -> Result<Side, String> {
    let text = || format!("{:?} to {:?}", range[0], range[1]);
    let mut lo = [0; 3];
    let mut hi = [0; 3];
    for d in 0..3 {
        let (a, b) = (range[0][d].min(range[1][d]), range[0][d].max(range[1][d]));
        let from_zero = |v: i64| v.checked_sub(1).and_then(|v| usize::try_from(v).ok());
        match (from_zero(a), from_zero(b)) {
            (Some(first), Some(last)) if last <= cells[d] => (lo[d], hi[d]) = (first, last),
            _ => {
                return Err(format!(
                    "nodes {} do not lie in a zone of {:?} nodes",
                    text(),
                    cells.map(|n| n + 1)
                ));
            }
        }
    }
    let flat: Vec<usize> = (0..3).filter(|&d| lo[d] == hi[d]).collect();
    let [axis] = flat[..] else {
        return Err(format!(
            "nodes {} do not make a face: one index must stay, two must go",
            text()
        ));
    };
    let face = match lo[axis] {
        0 => Face::new(axis, false),
        n if n == cells[axis] => Face::new(axis, true),
        _ => return Err(format!("nodes {} lie inside the zone, not on its surface", text())),
    };
    let [p, q] = face.directions();
    let window = Window::new([lo[p], lo[q]], [hi[p], hi[q]]);
    Ok(Side { block, face, window })
}

/// The range of nodes of a window, both directions ascending where `reverse` does not say otherwise.
pub(super) fn range(side: &Side, cells: [usize; 3], reverse: [bool; 2]) -> Range {
    let mut out = [[0i64; 3]; 2];
    let at = if side.face.is_max() { cells[side.face.axis()] } else { 0 };
    for end in &mut out {
        end[side.face.axis()] = at as i64 + 1;
    }
    for (n, d) in side.face.directions().into_iter().enumerate() {
        let ends = [side.window.lo[n] as i64 + 1, side.window.hi[n] as i64 + 1];
        (out[0][d], out[1][d]) = if reverse[n] {
            (ends[1], ends[0])
        } else {
            (ends[0], ends[1])
        };
    }
    out
}

/// `Transform` of an interface (SIDS, `GridConnectivity1to1_t`): entry m is the donor's direction that goes with our
/// direction m, negative where it runs backwards.
pub(super) fn transform(a: Face, b: Face, orientation: Orientation) -> [i64; 3] {
    let mut out = [0; 3];
    // Out of one block is into the other.
    let same_way = a.is_max() != b.is_max();
    out[a.axis()] = (b.axis() as i64 + 1) * if same_way { 1 } else { -1 };
    for (n, d) in a.directions().into_iter().enumerate() {
        let m = if orientation.swap { 1 - n } else { n };
        out[d] = (b.directions()[m] as i64 + 1) * if orientation.reverse[m] { -1 } else { 1 };
    }
    out
}

/// The orientation of an interface from its `Transform`; `None` where that does not lead from one face to the other.
pub(super) fn orientation(a: Face, b: Face, transform: [i64; 3]) -> Option<Orientation> {
    let donor = |d: usize| usize::try_from(transform[d].unsigned_abs()).ok()?.checked_sub(1);
    if donor(a.axis()) != Some(b.axis()) {
        return None;
    }
    let mut reverse = [false; 2];
    let mut to = [0; 2];
    for (n, d) in a.directions().into_iter().enumerate() {
        to[n] = b.directions().iter().position(|&e| Some(e) == donor(d))?;
        reverse[to[n]] = transform[d] < 0;
    }
    (to[0] != to[1]).then_some(Orientation {
        swap: to[0] == 1,
        reverse,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_have_one_name_each() {
        for kind in Condition::ALL {
            assert_eq!(condition(bc_type(kind)), Some(kind));
        }
    }

    #[test]
    fn transforms_and_orientations_are_each_others_inverse() {
        for a in Face::ALL {
            for b in Face::ALL {
                for o in Orientation::ALL {
                    let t = transform(a, b, o);
                    assert_eq!(orientation(a, b, t), Some(o), "{a} {b} {t:?}");
                    // The determinant of the transform's matrix is the same hand on both sides: SIDS asks for a proper one
                    // where both blocks are right-handed; the inverse transform is the one from b to a.
                    let back = transform(b, a, o.inverse());
                    for (d, &to) in t.iter().enumerate() {
                        let e = (to.unsigned_abs() - 1) as usize;
                        assert_eq!(back[e].unsigned_abs() as usize, d + 1);
                        assert_eq!(back[e].signum(), to.signum());
                    }
                }
            }
        }
    }

    #[test]
    fn ranges_and_windows_are_each_others_inverse() {
        let cells = [4, 3, 2];
        for face in Face::ALL {
            let [p, q] = face.directions();
            let window = Window::new([1, 0], [cells[p], cells[q] - 1]);
            let expected = Side { block: 7, face, window };
            for reverse in [[false, false], [true, false], [true, true]] {
                assert_eq!(side(7, cells, range(&expected, cells, reverse)), Ok(expected));
            }
        }
        assert!(side(0, cells, [[2, 1, 1], [2, 4, 3]]).unwrap_err().contains("inside"));
        assert!(
            side(0, cells, [[1, 1, 1], [1, 1, 3]])
                .unwrap_err()
                .contains("one index must stay")
        );
        assert!(
            side(0, cells, [[1, 1, 1], [1, 5, 3]])
                .unwrap_err()
                .contains("do not lie in a zone of [5, 4, 3] nodes")
        );
        assert!(side(0, cells, [[1, i64::MIN, 1], [1, i64::MAX, 3]]).is_err());
    }
}
