//! A contact event in the layout of the header.

use crate::ode::{HullEventKind, TouchEvent};
use nalgebra::Vector3;
use ode_sys::{dBodyID, dGeomID, dReal, dVector3};
use std::ffi::{c_int, c_uint};

/// A contact event; the header documents its fields.
#[allow(non_camel_case_types)]
#[repr(C)]
pub(super) struct dVisualHullEvent {
    kind: c_int,
    part: c_uint,
    body: dBodyID,
    geom: dGeomID,
    time: dReal,
    position: dVector3,
    normal: dVector3,
    depth_rate: dReal,
}

impl From<TouchEvent> for dVisualHullEvent {
    fn from(event: TouchEvent) -> Self {
        Self {
            kind: match event.kind {
                HullEventKind::Begin => 0,
                HullEventKind::End => 1,
            },
            part: event.part,
            body: event.toucher.body as dBodyID,
            geom: event.toucher.geom as dGeomID,
            time: event.time,
            position: padded(&event.position.coords),
            normal: padded(&event.normal),
            depth_rate: event.depth_rate,
        }
    }
}

fn padded(v: &Vector3<f64>) -> dVector3 {
    [v.x, v.y, v.z, 0.0]
}
