//! What the user asks: case files, units, atmosphere and scales.
