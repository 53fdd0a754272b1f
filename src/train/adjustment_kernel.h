#pragma once

#include <cstddef>

namespace clipgs {

/// Columns of the matrices that `multiply` writes come in multiples of this.
constexpr size_t kMatrixStep = 16;

/// A matrix [rows, columns] in memory: element (r, c) is at[r·row + c·column].
struct MatrixView {
  const float* at;
  size_t row;
  size_t column;
};

/// out[r·columns + c] = (add ? out : 0) + Σₖ a(r, k)·b[k·columns + c], for r < rows, k < inner;
/// `columns` is a multiple of kMatrixStep. Sums run over k in order.
void multiply(const MatrixView& a, const float* b, size_t rows, size_t inner, size_t columns,
              bool add, float* out);

}  // namespace clipgs
