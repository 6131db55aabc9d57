//! The outputs of a plan, on the host.

use super::{PortKind, pack};
use crate::frame::{FlowField, Plane};
use crate::plan::Port;

/// The values of a plan's outputs, in memory that is allocated once.
#[derive(Clone, Debug)]
pub struct Outputs(Vec<(&'static str, Output)>);

#[derive(Clone, Debug)]
enum Output {
    Plane(Plane),
    Flow(FlowField),
    Raw(Vec<f32>),
}

impl Outputs {
    pub(crate) fn new(ports: &[Port]) -> Self {
        let room = |port: &Port| {
            let output = match port.kind {
                PortKind::Plane { size, .. } => Output::Plane(Plane { size, data: vec![0.0; size.pixels()] }),
                PortKind::Flow { size } => {
                    Output::Flow(FlowField { size, data: vec![[0.0; 2]; size.pixels()] })
                }
                PortKind::Frame { .. } | PortKind::Raw { .. } => Output::Raw(vec![0.0; port.kind.len()]),
            };
            (port.name, output)
        };
        Self(ports.iter().map(room).collect())
    }

    /// Reads the output with this index from the beginning of `values`, which are laid out as in its buffer.
    pub(crate) fn unpack(&mut self, index: usize, values: &[f32]) {
        match &mut self.0[index].1 {
            Output::Plane(plane) => pack::unpack_plane(values, plane.size, &mut plane.data),
            Output::Flow(flow) => pack::unpack_flow(values, flow.size, &mut flow.data),
            Output::Raw(raw) => {
                let len = raw.len();
                raw.copy_from_slice(&values[..len]);
            }
        }
    }

    /// The flow field of an output of [`PortKind::Flow`], displacements in pixels; `None` if there is no such output.
    pub fn flow(&self, name: &str) -> Option<&FlowField> {
        self.0.iter().find_map(|(known, output)| match output {
            Output::Flow(flow) if *known == name => Some(flow),
            _ => None,
        })
    }

    /// The plane of an output of [`PortKind::Plane`], one value per pixel; `None` if there is no such output.
    pub fn plane(&self, name: &str) -> Option<&Plane> {
        self.0.iter().find_map(|(known, output)| match output {
            Output::Plane(plane) if *known == name => Some(plane),
            _ => None,
        })
    }

    /// The values of an output of [`PortKind::Raw`], or the words of a frame, laid out as in the buffer; `None` if
    /// there is no such output.
    pub fn raw(&self, name: &str) -> Option<&[f32]> {
        self.0.iter().find_map(|(known, output)| match output {
            Output::Raw(raw) if *known == name => Some(raw.as_slice()),
            _ => None,
        })
    }
}
