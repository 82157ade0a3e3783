//! Structured multi-block grids: made, read, checked.
