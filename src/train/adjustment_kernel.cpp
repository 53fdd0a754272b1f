// Compiled once per instruction set by Highway; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "train/adjustment_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands:
#include <algorithm>
#include <hwy/highway.h>

#include "train/adjustment_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kMatrixStep>;
using V = hn::Vec<D>;

constexpr size_t kRows = 4;  // that share each load of b: sums stay in registers

/// `rows` ≤ kRows rows of `out` from column `c` on, one step of columns.
HWY_INLINE void multiply_block(const MatrixView& a, const float* b, size_t rows, size_t inner,
                               size_t columns, size_t c, bool add, float* out) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  for (size_t v = 0; v < kMatrixStep; v += lanes) {
    const float* column = b + c + v;
    V sum0 = hn::Zero(d), sum1 = sum0, sum2 = sum0, sum3 = sum0;
    const float* a0 = a.at;
    // Rows that are not there repeat the last one; their sums are dropped.
    const float* a1 = a0 + std::min<size_t>(1, rows - 1) * a.row;
    const float* a2 = a0 + std::min<size_t>(2, rows - 1) * a.row;
    const float* a3 = a0 + std::min<size_t>(3, rows - 1) * a.row;
    for (size_t k = 0; k < inner; ++k) {
      const V line = hn::LoadU(d, column + k * columns);
      const size_t at = k * a.column;
      sum0 = hn::MulAdd(hn::Set(d, a0[at]), line, sum0);
      sum1 = hn::MulAdd(hn::Set(d, a1[at]), line, sum1);
      sum2 = hn::MulAdd(hn::Set(d, a2[at]), line, sum2);
      sum3 = hn::MulAdd(hn::Set(d, a3[at]), line, sum3);
    }
    const auto store = [&](size_t r, V sum) {
      if (r < rows) {
        float* to = out + r * columns + c + v;
        hn::StoreU(add ? hn::Add(hn::LoadU(d, to), sum) : sum, d, to);
      }
    };
    store(0, sum0);
    store(1, sum1);
    store(2, sum2);
    store(3, sum3);
  }
}

}  // namespace

void Multiply(const MatrixView& a, const float* b, size_t rows, size_t inner, size_t columns,
              bool add, float* out) {
  for (size_t r = 0; r < rows; r += kRows) {
    const MatrixView part{a.at + r * a.row, a.row, a.column};
    for (size_t c = 0; c < columns; c += kMatrixStep) {
      multiply_block(part, b, std::min(kRows, rows - r), inner, columns, c, add, out + r * columns);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clipgs {

HWY_EXPORT(Multiply);

void multiply(const MatrixView& a, const float* b, size_t rows, size_t inner, size_t columns,
              bool add, float* out) {
  HWY_DYNAMIC_DISPATCH(Multiply)(a, b, rows, inner, columns, add, out);
}

}  // namespace clipgs
#endif
