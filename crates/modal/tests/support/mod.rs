//! Meshes that several test files share.
#![allow(dead_code, reason = "every test file uses a part of these")]

use dip_modal::{
    Bar, BarSection, Dof, DofSet, MaterialAxis, Model, Node, Shell, ShellNodes, ShellSection, ShellThickness,
};
use nalgebra::Vector3;

/// Shape of the elements of a rectangular mesh.
#[derive(Clone, Copy, PartialEq)]
pub enum Cells {
    Quads,
    Triangles,
}

/// Rectangle 0..a by 0..b of nx x ny cells in one section; `place` moves the nodes.
pub fn rectangle(
    (a, b): (f64, f64),
    (nx, ny): (usize, usize),
    cells: Cells,
    section: ShellSection,
    place: impl Fn(f64, f64) -> Vector3<f64>,
) -> Model {
    let mut model = Model {
        shell_sections: vec![section],
        ..Model::default()
    };
    let id = |i: usize, j: usize| (1 + i + (nx + 1) * j) as u32;
    for j in 0..=ny {
        for i in 0..=nx {
            let p = place(a * i as f64 / nx as f64, b * j as f64 / ny as f64);
            model.nodes.push(Node::grid(id(i, j), p.x, p.y, p.z));
        }
    }
    let mut push = |nodes| {
        let id = 1 + model.shells.len() as u32;
        model.shells.push(Shell {
            id,
            nodes,
            section: 0,
            thickness: ShellThickness::Section,
            axis: MaterialAxis::Along(Vector3::x()),
            offset: 0.0,
        });
    };
    for j in 0..ny {
        for i in 0..nx {
            let (n1, n2, n3, n4) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
            match cells {
                Cells::Quads => push(ShellNodes::Quad([n1, n2, n3, n4])),
                // Alternating diagonals, so that the mesh has no preferred direction.
                Cells::Triangles if (i + j) % 2 == 0 => {
                    push(ShellNodes::Triangle([n1, n2, n3]));
                    push(ShellNodes::Triangle([n1, n3, n4]));
                }
                Cells::Triangles => {
                    push(ShellNodes::Triangle([n1, n2, n4]));
                    push(ShellNodes::Triangle([n2, n3, n4]));
                }
            }
        }
    }
    model
}

/// Numbers of the nodes that `select` takes by position.
pub fn nodes_where(model: &Model, select: impl Fn(&Vector3<f64>) -> bool) -> Vec<u32> {
    model
        .nodes
        .iter()
        .filter(|n| select(&n.position))
        .map(|n| n.id)
        .collect()
}

/// Hard simple support of a rectangle: w = 0 and no rotation along the edge.
pub fn simply_support(model: &mut Model, (a, b): (f64, f64)) {
    let tight = 1e-9;
    for n in &model.nodes {
        let p = n.position;
        let mut set = DofSet::NONE;
        // theta_x = w,y vanishes along an edge x = const., theta_y along y = const.
        if p.x < tight || p.x > a - tight {
            set = set.with(Dof::T3).with(Dof::R1);
        }
        if p.y < tight || p.y > b - tight {
            set = set.with(Dof::T3).with(Dof::R2);
        }
        if !set.is_empty() {
            model.supports.push((n.id, set));
        }
    }
}

/// A straight bar along x of `n` elements from node 1 to node n + 1.
pub fn straight_bar(length: f64, n: usize, section: BarSection) -> Model {
    let mut model = Model {
        bar_sections: vec![section],
        ..Model::default()
    };
    for i in 0..=n {
        model
            .nodes
            .push(Node::grid(1 + i as u32, length * i as f64 / n as f64, 0.0, 0.0));
    }
    for i in 0..n as u32 {
        model.bars.push(Bar {
            id: 1 + i,
            nodes: [1 + i, 2 + i],
            section: 0,
            orientation: Vector3::y(),
            offsets: [Vector3::zeros(); 2],
            pins: [DofSet::NONE; 2],
        });
    }
    model
}
