//! Setup and steps as protobuf messages, and back.

use prost::Message as _;

use crate::motion::MotionValue;
use crate::schema::{foxglove, wire};
use crate::setup::Setup;
use crate::step::{Convergence, Loads, Modal, Step};
use crate::surface::SurfacePatch;

/// How pressure coefficients are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits. Rounds a coefficient of order 1 by 3e-8, four orders below what a step converged by 2.5 orders leaves
    /// open, and halves the file.
    #[default]
    Single,
    /// 64 bits.
    Double,
}

fn flat(vectors: &[[f64; 3]]) -> Vec<f64> {
    vectors.as_flattened().to_vec()
}

/// Groups of three; none if the count is no multiple of three.
fn triples(flat: &[f64]) -> Option<Vec<[f64; 3]>> {
    let (triples, rest) = flat.as_chunks::<3>();
    rest.is_empty().then(|| triples.to_vec())
}

fn triple(flat: &[f64]) -> Option<[f64; 3]> {
    <[f64; 3]>::try_from(flat).ok()
}

pub(crate) fn grid(patch: &SurfacePatch) -> Vec<u8> {
    wire::SurfaceGrid {
        patch: patch.name.clone(),
        nodes_m: flat(&patch.nodes_m),
        faces: patch.faces.as_flattened().to_vec(),
        centroids_m: flat(&patch.centroids_m),
        areas_m2: flat(&patch.areas_m2),
        upper: patch.upper.clone(),
    }
    .encode_to_vec()
}

pub(crate) fn read_grid(bytes: &[u8]) -> Option<SurfacePatch> {
    let m = wire::SurfaceGrid::decode(bytes).ok()?;
    let (faces, rest) = m.faces.as_chunks::<4>();
    rest.is_empty().then_some(())?;
    Some(SurfacePatch {
        name: m.patch,
        nodes_m: triples(&m.nodes_m)?,
        faces: faces.to_vec(),
        centroids_m: triples(&m.centroids_m)?,
        areas_m2: triples(&m.areas_m2)?,
        upper: m.upper,
    })
}

pub(crate) fn mode(coordinate: &str, patch: &str, shape_m: &[[f64; 3]]) -> Vec<u8> {
    wire::SurfaceMode {
        coordinate: coordinate.to_owned(),
        patch: patch.to_owned(),
        displacements_m: flat(shape_m),
    }
    .encode_to_vec()
}

/// Names of coordinate and patch, and the displacement of its nodes.
pub(crate) fn read_mode(bytes: &[u8]) -> Option<(String, String, Vec<[f64; 3]>)> {
    let m = wire::SurfaceMode::decode(bytes).ok()?;
    Some((m.coordinate, m.patch, triples(&m.displacements_m)?))
}

pub(crate) fn motion(setup: &Setup, step: &Step) -> Vec<u8> {
    wire::Motion {
        step: step.number,
        time_s: step.time_s,
        coordinates: setup
            .motion
            .iter()
            .zip(&step.motion)
            .map(|(c, now)| wire::motion::Coordinate {
                name: c.name.clone(),
                unit: c.kind.unit().to_owned(),
                value: now.value,
                rate: now.rate,
            })
            .collect(),
    }
    .encode_to_vec()
}

pub(crate) fn pressure(step: &Step, patch: &str, cp: &[f64], precision: Precision) -> Vec<u8> {
    let mut message = wire::SurfacePressure {
        step: step.number,
        time_s: step.time_s,
        patch: patch.to_owned(),
        ..Default::default()
    };
    match precision {
        Precision::Single => message.cp = cp.iter().map(|v| *v as f32).collect(),
        Precision::Double => message.cp_double = cp.to_vec(),
    }
    message.encode_to_vec()
}

pub(crate) fn shape(step: &Step, patch: &str, nodes_m: &[[f64; 3]]) -> Vec<u8> {
    wire::SurfaceShape {
        step: step.number,
        time_s: step.time_s,
        patch: patch.to_owned(),
        nodes_m: flat(nodes_m),
    }
    .encode_to_vec()
}

pub(crate) fn loads(step: &Step) -> Vec<u8> {
    let l = &step.loads;
    wire::Loads {
        step: step.number,
        time_s: step.time_s,
        cl: l.cl,
        cd: l.cd,
        cm: l.cm,
        force_n: l.force_n.to_vec(),
        moment_n_m: l.moment_n_m.to_vec(),
    }
    .encode_to_vec()
}

pub(crate) fn modal(step: &Step, modal: &Modal) -> Vec<u8> {
    wire::Modal {
        step: step.number,
        time_s: step.time_s,
        q: modal.q.clone(),
        q_dot: modal.q_dot.clone(),
        force_j: modal.force_j.clone(),
    }
    .encode_to_vec()
}

pub(crate) fn convergence(step: &Step) -> Vec<u8> {
    let c = &step.convergence;
    wire::Convergence {
        step: step.number,
        time_s: step.time_s,
        orders: c.orders,
        iterations: c.iterations,
        converged: c.converged,
    }
    .encode_to_vec()
}

/// The wall's face centroids where they are now, coloured by Cp.
pub(crate) fn viewer(setup: &Setup, step: &Step, log_time_ns: u64) -> Vec<u8> {
    use foxglove::packed_element_field::NumericType;
    let nodes = step.nodes_m(setup);
    let mut data = Vec::with_capacity(16 * setup.surface.face_count());
    for ((patch, nodes), cp) in setup.surface.patches.iter().zip(&nodes).zip(&step.pressures) {
        for (face, cp) in patch.faces.iter().zip(cp) {
            for d in 0..3 {
                // The mean of the corners is close enough for a picture.
                let sum: f64 = face.iter().filter_map(|n| nodes.get(*n as usize)).map(|p| p[d]).sum();
                data.extend_from_slice(&((0.25 * sum) as f32).to_le_bytes());
            }
            data.extend_from_slice(&(*cp as f32).to_le_bytes());
        }
    }
    let field = |n: usize, name: &str| foxglove::PackedElementField {
        name: name.to_owned(),
        offset: 4 * n as u32,
        r#type: NumericType::Float32.into(),
    };
    foxglove::PointCloud {
        timestamp: Some(prost_types::Timestamp {
            seconds: (log_time_ns / 1_000_000_000) as i64,
            nanos: (log_time_ns % 1_000_000_000) as i32,
        }),
        frame_id: "grid".to_owned(),
        pose: Some(foxglove::Pose {
            position: Some(foxglove::Vector3::default()),
            orientation: Some(foxglove::Quaternion {
                w: 1.0,
                ..Default::default()
            }),
        }),
        point_stride: 16,
        fields: ["x", "y", "z", "cp"]
            .iter()
            .enumerate()
            .map(|(n, name)| field(n, name))
            .collect(),
        data,
    }
    .encode_to_vec()
}

/// One message of a step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Part {
    /// Values of the coordinates, with their names.
    Motion(Vec<(String, MotionValue)>),
    /// Pressure coefficients of a patch.
    Pressure(String, Vec<f64>),
    /// Nodes of a patch.
    Shape(String, Vec<[f64; 3]>),
    /// Resultants.
    Loads(Loads),
    /// The structure.
    Modal(Modal),
    /// How well the step was solved.
    Convergence(Convergence),
}

/// Number of the step, its instant, and the part; none where the bytes are not such a message. Topics without a part
/// (the viewer's, other programs') do not come here.
pub(crate) fn read_part(topic: &str, bytes: &[u8]) -> Option<(u32, f64, Part)> {
    use crate::schema;
    if topic == schema::MOTION.topic {
        let m = wire::Motion::decode(bytes).ok()?;
        let values = m.coordinates.into_iter().map(|c| {
            (
                c.name,
                MotionValue {
                    value: c.value,
                    rate: c.rate,
                },
            )
        });
        Some((m.step, m.time_s, Part::Motion(values.collect())))
    } else if topic == schema::PRESSURE.topic {
        let m = wire::SurfacePressure::decode(bytes).ok()?;
        let cp = match (m.cp.is_empty(), m.cp_double.is_empty()) {
            (_, true) => m.cp.iter().map(|v| f64::from(*v)).collect(),
            (true, false) => m.cp_double,
            (false, false) => return None,
        };
        Some((m.step, m.time_s, Part::Pressure(m.patch, cp)))
    } else if topic == schema::SURFACE_SHAPE.topic {
        let m = wire::SurfaceShape::decode(bytes).ok()?;
        Some((m.step, m.time_s, Part::Shape(m.patch, triples(&m.nodes_m)?)))
    } else if topic == schema::LOADS.topic {
        let m = wire::Loads::decode(bytes).ok()?;
        let loads = Loads {
            cl: m.cl,
            cd: m.cd,
            cm: m.cm,
            force_n: triple(&m.force_n)?,
            moment_n_m: triple(&m.moment_n_m)?,
        };
        Some((m.step, m.time_s, Part::Loads(loads)))
    } else if topic == schema::MODAL.topic {
        let m = wire::Modal::decode(bytes).ok()?;
        let modal = Modal {
            q: m.q,
            q_dot: m.q_dot,
            force_j: m.force_j,
        };
        Some((m.step, m.time_s, Part::Modal(modal)))
    } else if topic == schema::CONVERGENCE.topic {
        let m = wire::Convergence::decode(bytes).ok()?;
        let convergence = Convergence {
            orders: m.orders,
            iterations: m.iterations,
            converged: m.converged,
        };
        Some((m.step, m.time_s, Part::Convergence(convergence)))
    } else {
        None
    }
}
