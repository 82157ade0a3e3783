//! Dense complex matrices, stored by columns without padding, so that they can be written to a file as they are and
//! handed to faer without a copy.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par, c64};

/// A dense complex matrix, column-major without padding.
#[derive(Clone, Debug, PartialEq)]
pub struct ComplexMatrix {
    rows: usize,
    columns: usize,
    data: Vec<c64>,
}

impl ComplexMatrix {
    /// All zero.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            data: vec![c64::new(0.0, 0.0); rows * columns],
        }
    }

    /// From values by columns; `None` when the length is not `rows * columns`.
    pub fn from_columns(rows: usize, columns: usize, data: Vec<c64>) -> Option<Self> {
        (Some(data.len()) == rows.checked_mul(columns)).then_some(Self { rows, columns, data })
    }

    /// From a function of (row, column).
    pub fn from_fn(rows: usize, columns: usize, mut value: impl FnMut(usize, usize) -> c64) -> Self {
        let mut data = Vec::with_capacity(rows * columns);
        for j in 0..columns {
            for i in 0..rows {
                data.push(value(i, j));
            }
        }
        Self { rows, columns, data }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Values by columns.
    pub fn data(&self) -> &[c64] {
        &self.data
    }

    /// Values by columns, to change.
    pub fn data_mut(&mut self) -> &mut [c64] {
        &mut self.data
    }

    /// The values by columns, taken out.
    pub fn into_data(self) -> Vec<c64> {
        self.data
    }

    /// One column.
    pub fn column(&self, j: usize) -> &[c64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// A view for faer.
    pub fn view(&self) -> MatRef<'_, c64> {
        MatRef::from_column_major_slice(&self.data, self.rows, self.columns)
    }

    /// A mutable view for faer.
    pub fn view_mut(&mut self) -> MatMut<'_, c64> {
        MatMut::from_column_major_slice_mut(&mut self.data, self.rows, self.columns)
    }

    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.data.iter().all(|z| z.re.is_finite() && z.im.is_finite())
    }

    /// Frobenius norm.
    pub fn norm(&self) -> f64 {
        self.data.iter().map(c64::norm_sqr).sum::<f64>().sqrt()
    }

    /// Product with a matrix.
    ///
    /// # Panics
    /// When the inner sizes differ (a programming error).
    #[must_use]
    pub fn times(&self, right: &Self) -> Self {
        assert_eq!(self.columns, right.rows, "inner sizes of a product");
        let mut product = Self::zeros(self.rows, right.columns);
        let one = c64::new(1.0, 0.0);
        // One thread: the result may not depend on how many there are.
        matmul(
            product.view_mut(),
            Accum::Replace,
            self.view(),
            right.view(),
            one,
            Par::Seq,
        );
        product
    }
}

impl std::ops::Index<(usize, usize)> for ComplexMatrix {
    type Output = c64;
    fn index(&self, (i, j): (usize, usize)) -> &c64 {
        &self.data[j * self.rows + i]
    }
}

impl std::ops::IndexMut<(usize, usize)> for ComplexMatrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut c64 {
        &mut self.data[j * self.rows + i]
    }
}
