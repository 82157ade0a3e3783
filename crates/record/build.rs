//! Compiles the schemas of `proto/`: to Rust, and to the descriptors that go into every recording.

use std::path::Path;
use std::{env, fs};

use prost::Message as _;

const SCHEMAS: [&str; 9] = [
    "dip/convergence.proto",
    "dip/loads.proto",
    "dip/modal.proto",
    "dip/motion.proto",
    "dip/surface_grid.proto",
    "dip/surface_mode.proto",
    "dip/surface_pressure.proto",
    "dip/surface_shape.proto",
    "foxglove/PointCloud.proto",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=proto");
    let out = env::var("OUT_DIR")?;
    prost_build::Config::new().compile_fds(protox::compile(SCHEMAS, ["proto"])?)?;
    for schema in SCHEMAS {
        // A reader of the file must find everything in the descriptor itself: imports are in it, comments are not.
        let descriptor = protox::Compiler::new(["proto"])?
            .include_imports(true)
            .include_source_info(false)
            .open_file(schema)?
            .file_descriptor_set();
        let name = schema.replace(['/', '.'], "_");
        fs::write(Path::new(&out).join(name), descriptor.encode_to_vec())?;
    }
    Ok(())
}
