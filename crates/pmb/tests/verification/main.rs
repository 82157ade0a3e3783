//! Exact properties: fluxes, reconstruction, residual, order of accuracy, conservation.

mod cut;
mod exact_flow;
mod flux;
mod march;
mod order;
mod residual;
mod steady;
mod symmetry;
mod unsteady;

/// A small generator of repeatable numbers in [-1, 1).
pub struct Random(pub u64);

impl Random {
    /// The next number.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A unit vector.
    pub fn unit(&mut self) -> [f64; 3] {
        loop {
            let v = [self.uniform(), self.uniform(), self.uniform()];
            let l = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if l > 0.1 && l < 1.0 {
                return v.map(|x| x / l);
            }
        }
    }
}
