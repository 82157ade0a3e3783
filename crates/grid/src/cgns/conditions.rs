//! Boundary conditions of CGNS zones: where they hold and what they are.

use super::node::Node;
use super::read::{Zone, range};
use super::terms;
use crate::nmf;
use crate::topology::{MultiBlock, Patch, Side};

/// Adds the patches of zone `n`; what was guessed or passed over is noted.
pub(super) fn patches(
    grid: &mut MultiBlock,
    base: &Node,
    zone: &Zone,
    n: usize,
    notes: &mut Vec<String>,
) -> Result<(), String> {
    for bc in zone.node.labelled("ZoneBC_t").flat_map(|z| z.labelled("BC_t")) {
        let family = bc.labelled("FamilyName_t").next().and_then(Node::text);
        let name = family.unwrap_or(&bc.name).to_owned();
        let Some(side) = bc_side(grid, zone, n, bc).map_err(|e| format!("{}: {e}", bc.name))? else {
            notes.push(format!(
                "zone {}: {} was passed over: a PointRange on a face is needed",
                zone.node.name, bc.name
            ));
            continue;
        };
        let own = bc.text().unwrap_or_default();
        let of_family = || {
            let family = family?.rsplit('/').next()?;
            let family = base.labelled("Family_t").find(|f| f.name == family)?;
            terms::condition(family.labelled("FamilyBC_t").next()?.text()?)
        };
        let condition = match terms::condition(own).or_else(of_family) {
            Some(condition) => condition,
            // Conditions without a type on interfaces are how some programs name those.
            None if joined(grid, side) => continue,
            None => match nmf::condition(&name) {
                Some(guess) => {
                    notes.push(format!(
                        "zone {}: {} has the type {own}; from its name it is taken as {guess}",
                        zone.node.name, bc.name
                    ));
                    guess
                }
                None => {
                    notes.push(format!(
                        "zone {}: {} has the type {own}, which says no condition; it was passed over",
                        zone.node.name, bc.name
                    ));
                    continue;
                }
            },
        };
        grid.topology.patches.push(Patch {
            name,
            block: side.block,
            face: side.face,
            window: side.window,
            condition,
        });
    }
    Ok(())
}

fn joined(grid: &MultiBlock, side: Side) -> bool {
    let on = |s: Side| s.block == side.block && s.face == side.face && s.window.intersection(&side.window).is_some();
    grid.topology.interfaces.iter().any(|i| on(i.a) || on(i.b))
}

fn bc_side(grid: &MultiBlock, zone: &Zone, n: usize, bc: &Node) -> Result<Option<Side>, String> {
    let cells = grid.blocks[n].cells();
    let Some(node) = bc.child("PointRange").or_else(|| bc.child("ElementRange")) else {
        return Ok(None);
    };
    let mut range = range(node, zone.dimensions)?;
    let place = bc
        .labelled("GridLocation_t")
        .next()
        .and_then(Node::text)
        .unwrap_or("Vertex");
    if place != "Vertex" || node.name == "ElementRange" {
        // Faces, counted in their plane as cells: the last node is one further.
        let across = match place {
            "IFaceCenter" => Some(0),
            "JFaceCenter" => Some(1),
            "KFaceCenter" => Some(2),
            _ => (0..zone.dimensions)
                .find(|&d| range[0][d] == range[1][d] && [1, cells[d] as i64 + 1].contains(&range[0][d])),
        };
        let Some(across) = across.filter(|_| place.ends_with("Center") || node.name == "ElementRange") else {
            return Ok(None);
        };
        for d in (0..zone.dimensions).filter(|&d| d != across) {
            if range[0][d] > range[1][d] {
                (range[0][d], range[1][d]) = (range[1][d], range[0][d]);
            }
            range[1][d] = range[1][d].saturating_add(1);
        }
    }
    terms::side(n, cells, range).map(Some)
}
