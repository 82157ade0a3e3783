//! What is kept of time-accurate steps so that they can be gone on with to the same bits.

use serde::{Deserialize, Serialize};

use super::{DualTime, DualTimeSettings, TimeScheme, Wear};
use crate::error::FlowError;
use crate::moving::{Backward, Nodes, Swept};
use crate::secant::Secants;

/// Numbers of a run at the end of a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StateHeader {
    settings: DualTimeSettings,
    step: usize,
    wear: Wear,
    damping: f64,
    secants: Secants,
    pairs: usize,
    built: Option<(Backward, f64)>,
}

impl DualTime {
    /// Everything that the next steps follow from, preconditioner and first guesses included: a run that goes on from it
    /// has the same bits as one that never stopped. A header and doubles; call between steps.
    ///
    /// # Errors
    /// If the header cannot be made.
    pub fn save(&self) -> Result<(serde_json::Value, Vec<f64>), serde_json::Error> {
        let header = StateHeader {
            settings: self.settings,
            step: self.step,
            wear: self.wear,
            damping: self.solver.inertia.as_ref().map_or(0.0, |i| i.damping),
            secants: self.secants.clone(),
            pairs: self.secants.pairs.len(),
            built: self.built.as_ref().map(|b| (b.backward, b.damping)),
        };
        let long = self.settings.scheme == TimeScheme::Bdf2Opt;
        let mut out = Vec::new();
        out.extend_from_slice(&self.solver.unknowns);
        out.extend_from_slice(&self.history[0]);
        put_nodes(&mut out, &self.grid.now);
        put_swept(&mut out, &self.grid.swept);
        if long {
            out.extend_from_slice(&self.history[1]);
            put_swept(&mut out, &self.grid.swept_old);
        }
        for pair in &self.secants.pairs {
            for values in pair {
                out.extend(values.iter().map(|v| f64::from(*v)));
            }
        }
        if let Some(b) = &self.built {
            out.extend_from_slice(&b.unknowns);
            put_nodes(&mut out, &b.now);
            put_nodes(&mut out, &b.old);
            put_swept(&mut out, &b.swept_old);
            if long {
                put_swept(&mut out, &b.swept_older);
            }
        }
        Ok((serde_json::to_value(header)?, out))
    }

    /// Goes back to what was saved. The solver must be one for the same grid and settings.
    ///
    /// # Errors
    /// If the header or the number of values does not fit this run, or the saved grid or flow is not valid.
    pub fn restore(&mut self, header: &serde_json::Value, values: &[f64]) -> Result<(), FlowError> {
        let wrong = |what: String| FlowError::Restart {
            path: "unsteady state".to_owned(),
            what,
        };
        let header: StateHeader = serde_json::from_value(header.clone()).map_err(|e| wrong(format!("header: {e}")))?;
        if header.settings != self.settings {
            return Err(wrong(format!(
                "made with time settings {:?}, this run has {:?}",
                header.settings, self.settings
            )));
        }
        let short = || wrong("it holds fewer values than this grid needs: it is of another grid".to_owned());
        let mut from = values;
        let n = self.solver.unknowns.len();
        let unknowns = take(&mut from, n).ok_or_else(short)?;
        self.history[0].copy_from_slice(take(&mut from, n).ok_or_else(short)?);
        let mut now = self.grid.now.clone();
        get_nodes(&mut from, &mut now).ok_or_else(short)?;
        let mut swept = self.grid.swept.clone();
        get_swept(&mut from, &mut swept).ok_or_else(short)?;
        let long = self.settings.scheme == TimeScheme::Bdf2Opt;
        let mut swept_old = self.grid.swept_old.clone();
        if long {
            self.history[1].copy_from_slice(take(&mut from, n).ok_or_else(short)?);
            get_swept(&mut from, &mut swept_old).ok_or_else(short)?;
        }
        self.secants = header.secants;
        self.secants.pairs.clear();
        for _ in 0..header.pairs {
            let mut half = || -> Option<Vec<f32>> { Some(take(&mut from, n)?.iter().map(|v| *v as f32).collect()) };
            let (Some(w), Some(b)) = (half(), half()) else {
                return Err(short());
            };
            self.secants.pairs.push([w, b]);
        }
        self.built = None;
        if let Some((backward, damping)) = header.built {
            let unknowns = take(&mut from, n).ok_or_else(short)?.to_vec();
            get_nodes(&mut from, &mut self.grid.now).ok_or_else(short)?;
            get_nodes(&mut from, &mut self.grid.old).ok_or_else(short)?;
            get_swept(&mut from, &mut self.grid.swept_old).ok_or_else(short)?;
            if long {
                get_swept(&mut from, &mut self.grid.swept_older).ok_or_else(short)?;
            }
            // As it was when the preconditioner was built.
            self.backward = backward;
            self.place(|_| ())?;
            if let Some(inertia) = &mut self.solver.inertia {
                inertia.damping = damping;
            }
            self.solver.set(&unknowns);
            self.build()?;
        }
        self.wear = header.wear;
        if let Some(inertia) = &mut self.solver.inertia {
            inertia.damping = header.damping;
        }
        self.step = header.step;
        self.grid.now = now;
        self.grid.swept = swept;
        self.grid.swept_old = swept_old;
        self.solver.set(unknowns);
        self.solver.equations.check()
    }
}

fn put_nodes(out: &mut Vec<f64>, nodes: &Nodes) {
    nodes.blocks.iter().flatten().for_each(|c| out.extend_from_slice(c));
}

fn put_swept(out: &mut Vec<f64>, swept: &[Swept]) {
    swept.iter().flatten().for_each(|c| out.extend_from_slice(c));
}

fn take<'a>(from: &mut &'a [f64], n: usize) -> Option<&'a [f64]> {
    let (head, tail) = from.split_at_checked(n)?;
    *from = tail;
    Some(head)
}

fn get_nodes(from: &mut &[f64], nodes: &mut Nodes) -> Option<()> {
    nodes
        .blocks
        .iter_mut()
        .flatten()
        .try_for_each(|c| take(from, c.len()).map(|v| c.copy_from_slice(v)))
}

fn get_swept(from: &mut &[f64], swept: &mut [Swept]) -> Option<()> {
    swept
        .iter_mut()
        .flatten()
        .try_for_each(|c| take(from, c.len()).map(|v| c.copy_from_slice(v)))
}
