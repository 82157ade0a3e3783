//! One type for each kind of case file. Every key has a doc comment; the JSON Schemas are made from these types.

mod correct;
mod flutter;
mod march;
mod mesh;
mod pitch;
mod steady;
mod structure;
mod study;
mod wing;

pub use correct::{CorrectMethod, CorrectTable, RecordingsTable, Sampling};
pub use flutter::{
    Approximation, ControlSurfaceTable, FlutterFile, FlutterTable, KernelKind, LatticeTable, Method, ModesTable,
    Points, ReferenceTable, Search, SplineKind, SplineTable, SurfaceTable, Symmetry,
};
pub use march::{
    CouplingKind, MarchFile, MarchTable, ModalDamping, SearchParameter, SearchTable, StartMode, StartWord,
    StructureScheme, WallDisplacement,
};
pub use mesh::MeshTable;
pub use pitch::{Amount, HarmonicTable, MotionKind, MotionLaw, MotionTable, PitchFile, TimeSchemeKind, TimeTable};
pub use steady::{
    CutsTable, FarFieldKind, FlowModel, FlowTable, LoadReferenceTable, PatchTable, ReconstructionKind, SteadyFile,
    SteadyTable,
};
pub use structure::{
    Clamp, ClampSpec, MassModel, MassTable, MaterialTable, Normalization, PlateTable, SpringTable, StructureFile,
    StructureModes, SupportTable, ThicknessRule,
};
pub use study::{CurveKind, CurveTable, PublishedTable, StudyFile};
pub use wing::{SectionTable, WingFile};

/// The JSON Schema of each kind of file, by file name.
pub fn schemas() -> Vec<(&'static str, schemars::Schema)> {
    vec![
        ("wing", schemars::schema_for!(WingFile)),
        ("structure", schemars::schema_for!(StructureFile)),
        ("flutter", schemars::schema_for!(FlutterFile)),
        ("study", schemars::schema_for!(StudyFile)),
        ("steady", schemars::schema_for!(SteadyFile)),
        ("pitch", schemars::schema_for!(PitchFile)),
        ("march", schemars::schema_for!(MarchFile)),
    ]
}
