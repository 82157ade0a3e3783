//! Writes `docs/schema.md` from the schemas in `proto/`: `cargo run --release -p dip-record --example schema_page`.

use std::fmt::Write as _;

use dip_record::schema::{CHANNELS, FORMAT, PROFILE};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, EnumDescriptorProto, FileDescriptorProto};

/// Metadata records: record, key, unit, meaning. A test compares the keys with those of a file.
pub const METADATA: &[(&str, &str, &str, &str)] = &[
    ("dip.file", "format", "", "version of this format"),
    ("dip.file", "program", "", "program that ran, for example `pmb pitch`"),
    ("dip.file", "version", "", "its version, with the commit"),
    ("dip.file", "mesh_sha256", "", "SHA-256 of the mesh"),
    ("dip.case", "name", "", "name of the case"),
    ("dip.case", "text", "", "the case file as it was read"),
    ("dip.references", "model", "", "flow model, for example `euler`"),
    ("dip.references", "mach", "", "Mach number of the stream"),
    ("dip.references", "speed_m_s", "m/s", "its speed U"),
    ("dip.references", "density_kg_m3", "kg/m^3", "its density"),
    ("dip.references", "pressure_pa", "Pa", "its static pressure"),
    ("dip.references", "gamma", "", "ratio of specific heats"),
    (
        "dip.references",
        "reynolds",
        "",
        "Reynolds number on the reference chord; not there in inviscid flow",
    ),
    (
        "dip.references",
        "alpha_deg",
        "deg",
        "incidence of the stream to the grid's x axis, nose up",
    ),
    (
        "dip.references",
        "reference_semichord_m",
        "m",
        "b in the reduced frequency k = omega b / U",
    ),
    (
        "dip.references",
        "reference_chord_m",
        "m",
        "chord of moment coefficients",
    ),
    (
        "dip.references",
        "reference_area_m2",
        "m^2",
        "area of coefficients, of what is modelled",
    ),
    (
        "dip.references",
        "span_m",
        "m",
        "span of the whole wing, also in a half model",
    ),
    (
        "dip.references",
        "moment_point_m",
        "m",
        "point of moment coefficients: x y z",
    ),
    (
        "dip.references",
        "grid_unit_m",
        "m",
        "length of one unit of the flow solver's grid",
    ),
    (
        "dip.references",
        "half_model",
        "",
        "`true` if y = 0 is a plane of symmetry",
    ),
    ("dip.references", "time_step_s", "s", "time between two steps"),
    (
        "dip.references",
        "steps_per_cycle",
        "",
        "steps in a cycle of the first harmonic; not there if there is none",
    ),
    (
        "dip.references",
        "cycles_asked",
        "",
        "cycles that the case asked for; not there if it asked for none",
    ),
    (
        "dip.references",
        "orders_asked",
        "",
        "orders of magnitude by which each step's residual was to fall",
    ),
    ("dip.motion.N", "name", "", "name of the coordinate"),
    ("dip.motion.N", "kind", "", "`pitch`, `plunge`, `mode` or `control`"),
    ("dip.motion.N", "unit", "", "unit of the coordinate: `rad`, `m` or `1`"),
    (
        "dip.motion.N",
        "axis_point_m",
        "m",
        "pitch, control: a point of the axis",
    ),
    (
        "dip.motion.N",
        "axis_direction",
        "",
        "pitch, control: its direction; positive by the right-hand rule, so along +y nose up",
    ),
    ("dip.motion.N", "direction", "", "plunge: direction of positive values"),
    ("dip.motion.N", "law", "", "`harmonic`, `pulse`, `ramp` or `free`"),
    (
        "dip.motion.N",
        "mean",
        "unit",
        "harmonic, pulse, ramp: mean, or value before",
    ),
    (
        "dip.motion.N",
        "phase_origin_s",
        "s",
        "harmonic: instant from which the phases count",
    ),
    ("dip.motion.N", "harmonics", "", "harmonic: how many sines there are"),
    (
        "dip.motion.N",
        "omega_rad_s.n",
        "rad/s",
        "circular frequency of sine n = 1, 2, ...",
    ),
    ("dip.motion.N", "amplitude.n", "unit", "its amplitude"),
    (
        "dip.motion.N",
        "phase_rad.n",
        "rad",
        "its phase: the value is mean + sum of amplitude sin(omega (t - phase origin) + phase)",
    ),
    ("dip.motion.N", "amplitude", "unit", "pulse, ramp: height"),
    ("dip.motion.N", "start_s", "s", "pulse, ramp: beginning"),
    ("dip.motion.N", "duration_s", "s", "pulse, ramp: duration"),
    ("dip.motion.N", "formula", "", "pulse, ramp: the formula"),
    (
        "dip.motion.N",
        "mode_number",
        "",
        "number of the structural mode behind the coordinate, from 1",
    ),
    (
        "dip.motion.N",
        "mode_omega_rad_s",
        "rad/s",
        "its natural circular frequency",
    ),
    ("dip.motion.N", "mode_generalized_mass_kg", "kg", "its generalized mass"),
    ("dip.motion.N", "mode_damping_ratio", "", "its part of critical damping"),
    ("dip.check", "crc32", "", "CRC-32 of all records above"),
    (
        "dip.end",
        "reason",
        "",
        "why the run ended; the record is not there if the run was killed",
    ),
];

/// Three lines that read a recording; a test runs them.
pub const PYTHON: &str = r#"from mcap.reader import make_reader; from mcap_protobuf.decoder import DecoderFactory
reader = make_reader(open("pitch.mcap", "rb"), validate_crcs=True, decoder_factories=[DecoderFactory()])
for schema, channel, message, loads in reader.iter_decoded_messages("/loads"): print(loads.time_s, loads.cl, loads.cm)
"#;

/// The page.
pub fn page() -> Result<String, Box<dyn std::error::Error>> {
    let mut out = String::new();
    write!(
        out,
        "# Recordings: channels and schemas

<!-- Made by `cargo run --release -p dip-record --example schema_page` from `crates/record/proto`; a test keeps it up to date. -->

A recording is an [MCAP](https://mcap.dev) file, profile `{PROFILE}`, format {FORMAT}, with protobuf messages in zstd chunks. It holds no
dates: the same run makes the same file. Everything is in SI units; x aft, y to starboard, z up. Log time is simulated time in
nanoseconds from 0; every message of a step also carries its instant `time_s` in seconds, the same to the bit in all of them.

Chunks end after a fixed number of steps (5 by default) and are then with the operating system: a killed run loses at most the
steps since. Metadata and one chunk with the channels, the surface and the shapes of modes come first. Chunks, data section and
index have checksums; metadata have one of their own, so that they can be trusted in a file without an end. With every restart
file the recording is forced to the disk.

Files that other programs wrote or rewrote are read too: packed by zstd, lz4 or not at all, with or without chunks, index, statistics and
checksums, messages in any order, other channels beside ours. The sequence number of a message may be 0; the log time must be
the instant, to a nanosecond. A finished file may leave `dip.check` and the profile out. `dip doctor` names channels with another
schema or encoding, messages that stand there twice (alike: one is taken; contradicting: the step is lost), and missing steps.

    dip info FILE       what it holds
    dip export FILE     as tables, JSON, ParaView files, or first harmonics
    dip doctor FILE     what is wrong with it and what can be saved

In Python (`pip install mcap mcap-protobuf-support`), for example:

```python
{PYTHON}```

Metadata: `for m in reader.iter_metadata(): print(m.name, m.metadata)`. A file of a killed run has no index, which that package
wants: `dip doctor --save` makes one that has.

General viewers of MCAP files draw `/viewer/wing` in their 3-D panel: points where the wall's faces are at that instant, coloured by
the field `cp`. They plot `/loads` and `/motion` as they are.

## Channels

| topic | schema | in every recording |
|---|---|---|
"
    )?;
    for channel in CHANNELS {
        writeln!(
            out,
            "| `{}` | `{}` | {} |",
            channel.topic,
            channel.schema,
            if channel.required { "yes" } else { "no" }
        )?;
    }
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/proto");
    out.push_str("\n## Messages\n");
    for channel in CHANNELS {
        let name = channel.schema.rsplit('.').next().unwrap_or_default();
        let folder = channel.schema.split('.').next().unwrap_or_default();
        let file = if folder == "dip" { snake(name) } else { name.to_owned() };
        let path = format!("{folder}/{file}.proto");
        let set = protox::compile([&path], [root])?;
        let file = set.file.iter().find(|f| f.name() == path).ok_or("no such file")?;
        for (n, message) in file.message_type.iter().enumerate() {
            describe(&mut out, file, message, file.package(), &[4, n as i32])?;
        }
    }
    out.push_str("\n## Metadata\n\nNumbers are text with the digits that give the same double back; vectors are three numbers.\n");
    let mut record = "";
    for (name, key, unit, meaning) in METADATA {
        if *name != record {
            write!(out, "\n### `{name}`\n\n| key | unit | meaning |\n|---|---|---|\n")?;
            record = name;
        }
        writeln!(out, "| `{key}` | {unit} | {meaning} |")?;
    }
    Ok(out)
}

/// `SurfaceGrid` as `surface_grid`.
fn snake(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        if c.is_ascii_uppercase() && !out.is_empty() {
            out.push('_');
        }
        out.push(c.to_ascii_lowercase());
    }
    out
}

/// Comment above an item, on one line.
fn comment(file: &FileDescriptorProto, path: &[i32]) -> String {
    let location = file
        .source_code_info
        .iter()
        .flat_map(|i| &i.location)
        .find(|l| l.path == path);
    let text = location.map_or("", |l| l.leading_comments());
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn describe(
    out: &mut String,
    file: &FileDescriptorProto,
    message: &DescriptorProto,
    scope: &str,
    path: &[i32],
) -> std::fmt::Result {
    let name = format!("{scope}.{}", message.name());
    write!(out, "\n### `{name}`\n\n{}\n\n", comment(file, path))?;
    out.push_str("| field | number | type | meaning |\n|---|---|---|---|\n");
    for (n, field) in message.field.iter().enumerate() {
        let kind = match field.r#type() {
            Type::Message | Type::Enum => field.type_name().trim_start_matches('.').to_owned(),
            basic => basic.as_str_name().trim_start_matches("TYPE_").to_lowercase(),
        };
        let repeated = if field.label() == Label::Repeated {
            "repeated "
        } else {
            ""
        };
        let meaning = comment(file, &[path, &[2, n as i32]].concat());
        writeln!(
            out,
            "| `{}` | {} | {repeated}{kind} | {meaning} |",
            field.name(),
            field.number()
        )?;
    }
    for (n, nested) in message.nested_type.iter().enumerate() {
        describe(out, file, nested, &name, &[path, &[3, n as i32]].concat())?;
    }
    for (n, nested) in message.enum_type.iter().enumerate() {
        values(out, file, nested, &name, &[path, &[4, n as i32]].concat())?;
    }
    Ok(())
}

fn values(
    out: &mut String,
    file: &FileDescriptorProto,
    nested: &EnumDescriptorProto,
    scope: &str,
    path: &[i32],
) -> std::fmt::Result {
    write!(
        out,
        "\n### `{scope}.{}`\n\n{}\n\n| value | number |\n|---|---|\n",
        nested.name(),
        comment(file, path)
    )?;
    for value in &nested.value {
        writeln!(out, "| `{}` | {} |", value.name(), value.number())?;
    }
    Ok(())
}

/// Writes the page.
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/schema.md");
    std::fs::write(path, page()?)?;
    Ok(())
}
