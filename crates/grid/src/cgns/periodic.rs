//! Periodic interfaces of CGNS files (SIDS, `Periodic_t`): a shift, or a turn about an axis of coordinates.

use super::coordinate_axis;
use super::node::{Data, Node, Precision};
use crate::period::Period;
use crate::vector::{norm, sub};

/// What is periodic about an interface; `None` if nothing is.
pub(super) fn read(interface: &Node, dimensions: usize) -> Result<Option<Period>, String> {
    let Some(node) = interface
        .labelled("GridConnectivityProperty_t")
        .find_map(|p| p.labelled("Periodic_t").next())
    else {
        return Ok(None);
    };
    // Two-dimensional grids stand in the plane (x, z).
    let vector = |name: &str| -> Result<[f64; 3], String> {
        let values = node.child(name).and_then(Node::reals).unwrap_or_default();
        if values.iter().any(|v| !v.is_finite()) {
            return Err(format!("{name} is {values:?}"));
        }
        let at = |d: usize| values.get(d).copied().unwrap_or(0.0);
        Ok(if dimensions == 2 {
            [at(0), 0.0, at(1)]
        } else {
            [at(0), at(1), at(2)]
        })
    };
    let (angles, centre, way) = (
        vector("RotationAngle")?,
        vector("RotationCenter")?,
        vector("Translation")?,
    );
    if angles == [0.0; 3] {
        return Ok((way != [0.0; 3]).then_some(Period::Translation(way)));
    }
    let turning: Vec<usize> = (0..3).filter(|&d| angles[d] != 0.0).collect();
    let &[d] = &turning[..] else {
        return Err(format!(
            "RotationAngle is {angles:?}: turns about one axis of coordinates are understood"
        ));
    };
    if dimensions == 2 || way != [0.0; 3] {
        return Err("a turn in a plane, or one with a shift, is not understood".into());
    }
    let mut axis = [0.0; 3];
    axis[d] = 1.0;
    Ok(Some(Period::Rotation {
        centre,
        axis,
        angle_deg: angles[d].to_degrees(),
    }))
}

/// The period again with the digits that the file, which has it in single precision, lost: where the first pair of nodes
/// agrees with it, they know a shift better, and a turn is what the nearest whole part of a circle is.
pub(super) fn sharpened(period: Period, from: [f64; 3], to: [f64; 3]) -> Period {
    match period {
        Period::Translation(way) => {
            let apart = sub(to, from);
            if norm(sub(apart, way)) <= 1e-6 * norm(way) {
                Period::Translation(apart)
            } else {
                period
            }
        }
        Period::Rotation {
            centre,
            axis,
            angle_deg,
        } => {
            let near = |wanted: f64| (angle_deg / wanted - 1.0).abs() < 1e-6;
            let part = 360.0 / (360.0 / angle_deg).round();
            let tenth = (angle_deg * 10.0).round() / 10.0;
            let angle_deg = [part, tenth].into_iter().find(|&v| near(v)).unwrap_or(angle_deg);
            Period::Rotation {
                centre,
                axis,
                angle_deg,
            }
        }
    }
}

/// The node for a period, `None` for a turn about an axis that is none of the coordinates'.
pub(super) fn write(period: Period) -> Option<Node> {
    let (centre, angles, way) = match period {
        Period::Translation(way) => ([0.0; 3], [0.0; 3], way),
        Period::Rotation {
            centre,
            axis,
            angle_deg,
        } => {
            let d = coordinate_axis(axis)?;
            let mut angles = [0.0; 3];
            angles[d] = angle_deg.to_radians() * axis[d].signum();
            (centre, angles, [0.0; 3])
        }
    };
    let vector = |name: &str, v: [f64; 3]| {
        // The CGNS library takes these in single precision only.
        Node::new(name, "DataArray_t", Data::Reals(vec![3], v.to_vec(), Precision::Single))
    };
    let periodic = Node::new("Periodic", "Periodic_t", Data::None)
        .with(vector("RotationCenter", centre))
        .with(vector("RotationAngle", angles))
        .with(vector("Translation", way));
    Some(Node::new("GridConnectivityProperty", "GridConnectivityProperty_t", Data::None).with(periodic))
}
