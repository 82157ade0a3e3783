//! Time and memory of one modal analysis: `cargo run --release -p dip-modal --example speed -- [plate|shell] [cells] [modes]`.
//! Prints degrees of freedom, processor seconds of assembly and modes, and the peak of the resident memory.

use dip_modal::{
    DofSet, Material, MaterialAxis, Model, ModesRequest, Node, Shell, ShellNodes, ShellSection, ShellThickness,
};
use nalgebra::Vector3;

fn status(key: &str) -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let value = text
        .lines()
        .find_map(|l| l.strip_prefix(key)?.split_whitespace().next()?.parse().ok());
    value.unwrap_or(f64::NAN)
}

/// Processor time of the process, seconds (fields 14 and 15 of /proc/self/stat, in ticks of 10 ms).
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = text.rsplit(')').next().unwrap_or_default();
    after
        .split_whitespace()
        .skip(11)
        .take(2)
        .filter_map(|t| t.parse::<f64>().ok())
        .sum::<f64>()
        / 100.0
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let shell = args.get(1).is_some_and(|a| a == "shell");
    let cells: usize = args.get(2).map_or(Ok(if shell { 70 } else { 99 }), |a| a.parse())?;
    let count: usize = args.get(3).map_or(Ok(20), |a| a.parse())?;
    let material = Material::isotropic(7.0e10, 0.3, 2700.0);
    let section = if shell {
        ShellSection::shell(1, material, 2e-3)
    } else {
        ShellSection::thin_plate(1, material, 2e-3)
    };
    let mut model = Model {
        shell_sections: vec![section],
        ..Model::default()
    };
    let id = |i: usize, j: usize| (1 + i + (cells + 1) * j) as u32;
    for j in 0..=cells {
        for i in 0..=cells {
            let (x, y) = (i as f64 / cells as f64, j as f64 / cells as f64);
            let z = if shell { 0.1 * x * (1.0 - x) } else { 0.0 };
            model.nodes.push(Node::grid(id(i, j), x, y, z));
        }
        model.supports.push((id(0, j), DofSet::ALL));
    }
    for j in 0..cells {
        for i in 0..cells {
            model.shells.push(Shell {
                id: (1 + i + cells * j) as u32,
                nodes: ShellNodes::Quad([id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]),
                section: 0,
                thickness: ShellThickness::Section,
                axis: MaterialAxis::Along(Vector3::x()),
                offset: 0.0,
            });
        }
    }
    let start = cpu_s();
    let system = model.assemble()?;
    let assembled = cpu_s();
    let modes = system.modes(&ModesRequest::lowest(count))?;
    let solved = cpu_s();
    println!(
        "{} free degrees of freedom, {} modes: assembly {:.2} s, modes {:.2} s, together {:.2} s of processor time; peak {:.0} MB",
        system.size(),
        modes.count(),
        assembled - start,
        solved - assembled,
        solved - start,
        status("VmHWM:") / 1024.0
    );
    println!(
        "first {:.5} Hz, last {:.5} Hz, largest residual {:.1e}",
        modes.freq_hz(0),
        modes.freq_hz(count - 1),
        modes.residual.iter().fold(0.0_f64, |m, r| m.max(*r))
    );
    Ok(())
}
