//! Errors as Python exceptions; their classes are in `errors.py`.

use std::ffi::CString;

use bitgrain::error::Error;
use bitgrain_kernel::Error as KernelError;
use pyo3::prelude::*;
use serde_json::{Value, json};

/// The exception of a class in `errors.py` with a message and attributes.
fn exception(class: &str, message: &str, attributes: &Value) -> PyErr {
    Python::attach(|py| {
        let made = py.import("bitgrain.errors").and_then(|module| {
            let arguments = (class, message, attributes.to_string());
            module.getattr("made")?.call1(arguments)
        });
        made.map_or_else(|wrong| wrong, PyErr::from_value)
    })
}

/// Something wrong with an argument: where, what, and what was expected.
pub fn input(place: &str, problem: impl Into<String>) -> PyErr {
    laboratory(&Error::input(place, problem))
}

/// The name of a kernel's error and its fields, as its data type has them.
fn named(fault: &KernelError) -> (String, Value) {
    let mut attributes = json!({});
    let name = match serde_json::to_value(fault) {
        Ok(Value::String(name)) => name,
        Ok(Value::Object(one)) => match one.into_iter().next() {
            Some((name, fields)) => {
                attributes = fields;
                name
            }
            None => String::new(),
        },
        _ => String::new(),
    };
    attributes["code"] = fault.code().into();
    (name, attributes)
}

/// An error of the kernel.
pub fn kernel(fault: KernelError) -> PyErr {
    let (name, attributes) = named(&fault);
    exception(&name, &fault.to_string(), &attributes)
}

/// A world that another thread, or a numpy operation in progress, is using.
pub fn busy() -> PyErr {
    let message = "the world is in use: another thread steps or edits it, or an operation still reads its memory; \
                   wait for it, or work on copies";
    exception("Busy", message, &json!({}))
}

/// A time step that does not resolve waves and collisions, of a world that is strict.
pub fn long_step(problem: &str) -> PyErr {
    exception("LongTimeStep", &format!("dt {problem}"), &json!({}))
}

/// Warns of such a time step, of the line that steps.
///
/// # Errors
/// What the filter of warnings makes of it.
pub fn warn_long_step(py: Python<'_>, problem: &str) -> PyResult<()> {
    let text = CString::new(format!("dt {problem}"))?;
    let kind = py
        .import("bitgrain.errors")?
        .getattr("LongTimeStepWarning")?;
    PyErr::warn(py, &kind, &text, 1)
}

/// A view of a state that is gone.
pub fn stale() -> PyErr {
    let message = "the view is of an earlier state: the world was stepped or edited since; take it again from the \
                   world, or keep a copy()";
    exception("StaleView", message, &json!({}))
}

/// An error of the laboratory.
pub fn laboratory(error: &Error) -> PyErr {
    let mut attributes = json!({});
    let class = match error {
        Error::Input { place, problem } => {
            attributes = json!({ "place": place, "problem": problem });
            "InputError"
        }
        Error::Damaged { place, problem } => {
            attributes = json!({ "place": place, "problem": problem });
            "Damaged"
        }
        Error::Manifest { place, problem } => {
            attributes = json!({ "place": place, "problem": problem });
            "BadManifest"
        }
        Error::Run {
            stage, step, fault, ..
        } => {
            let (fault_name, fields) = named(fault);
            attributes = json!({ "stage": stage, "step": step, "code": fault.code(), "fault": fault_name,
                "fields": fields });
            "RunFailed"
        }
        Error::Unsettled {
            bed,
            step,
            energy,
            bound,
            carried,
        } => {
            attributes = json!({ "bed": bed, "step": step, "energy": energy, "bound": bound, "carried": carried });
            "Unsettled"
        }
        Error::Unfit { place, problem } => {
            attributes = json!({ "place": place, "problem": problem });
            "Unfit"
        }
        Error::Unverified { problem, .. } => {
            attributes = json!({ "problem": problem });
            "Unverified"
        }
        Error::Failed {
            failed,
            done,
            table,
        } => {
            attributes = json!({ "failed": failed, "done": done, "table": table });
            "MembersFailed"
        }
        Error::Parted => "Parted",
        Error::Interrupted { stage, step, saved } => {
            attributes = json!({ "stage": stage, "step": step, "saved": saved });
            "Interrupted"
        }
        Error::Contract { problem } => {
            attributes = json!({ "problem": problem });
            "ContractBroken"
        }
        Error::Memory { what, bytes } => {
            attributes = json!({ "what": what, "bytes": bytes });
            "OutOfMemory"
        }
        Error::Write { path, .. } => {
            attributes = json!({ "path": path });
            "WriteFailed"
        }
        Error::Output(_) => "OutputFailed",
    };
    attributes["exit_status"] = error.exit_status().into();
    exception(class, &error.to_string(), &attributes)
}
