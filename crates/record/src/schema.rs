//! Channels of a recording and the schemas behind them, compiled from `proto/`.

/// Messages of the package `dip`, generated from `proto/dip`.
pub(crate) mod wire {
    include!(concat!(env!("OUT_DIR"), "/dip.rs"));
}

/// The well-known message that general viewers draw, generated from `proto/foxglove`.
pub(crate) mod foxglove {
    include!(concat!(env!("OUT_DIR"), "/foxglove.rs"));
}

/// Version of the format; changes when an older reader would misunderstand a newer file.
pub const FORMAT: &str = "1";

/// Profile in the header of the file.
pub const PROFILE: &str = "dip";

/// A channel: its topic, its schema, and the descriptor that goes into the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Topic.
    pub topic: &'static str,
    /// Full name of the message.
    pub schema: &'static str,
    /// Encoded `FileDescriptorSet` with all imports.
    pub descriptor: &'static [u8],
    /// True if no recording is without it.
    pub required: bool,
}

macro_rules! channel {
    ($topic:literal, $schema:literal, $file:literal, $required:literal) => {
        Channel {
            topic: $topic,
            schema: $schema,
            descriptor: include_bytes!(concat!(env!("OUT_DIR"), "/", $file)),
            required: $required,
        }
    };
}

pub(crate) const SURFACE_GRID: Channel = channel!("/surface/grid", "dip.SurfaceGrid", "dip_surface_grid_proto", true);
pub(crate) const SURFACE_MODE: Channel = channel!("/surface/mode", "dip.SurfaceMode", "dip_surface_mode_proto", false);
pub(crate) const MOTION: Channel = channel!("/motion", "dip.Motion", "dip_motion_proto", true);
pub(crate) const PRESSURE: Channel = channel!(
    "/surface/pressure",
    "dip.SurfacePressure",
    "dip_surface_pressure_proto",
    true
);
pub(crate) const SURFACE_SHAPE: Channel =
    channel!("/surface/shape", "dip.SurfaceShape", "dip_surface_shape_proto", false);
pub(crate) const LOADS: Channel = channel!("/loads", "dip.Loads", "dip_loads_proto", true);
pub(crate) const MODAL: Channel = channel!("/modal", "dip.Modal", "dip_modal_proto", false);
pub(crate) const VIEWER: Channel = channel!(
    "/viewer/wing",
    "foxglove.PointCloud",
    "foxglove_PointCloud_proto",
    false
);
pub(crate) const CONVERGENCE: Channel = channel!("/convergence", "dip.Convergence", "dip_convergence_proto", true);

/// All channels; a file numbers them from 1 in this order.
pub const CHANNELS: [Channel; 9] = [
    SURFACE_GRID,
    SURFACE_MODE,
    MOTION,
    PRESSURE,
    SURFACE_SHAPE,
    LOADS,
    MODAL,
    VIEWER,
    CONVERGENCE,
];
