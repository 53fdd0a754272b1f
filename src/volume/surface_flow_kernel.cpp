// Compiled once per instruction set by Highway; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/surface_flow_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands:
#include <hwy/highway.h>
#include <limits>

#include "volume/surface_flow_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kFlowBlock>;
using V = hn::Vec<D>;

/// What lies around voxels next to each other.
struct Neighbours {
  const float* values;

  V at(std::ptrdiff_t offset) const { return hn::LoadU(D(), values + offset); }
  /// Of a second derivative along two axes.
  V mixed(std::ptrdiff_t a, std::ptrdiff_t b) const {
    return hn::Add(hn::Sub(hn::Sub(at(a + b), at(a - b)), at(b - a)), at(-a - b));
  }
};

HWY_INLINE void flow_voxels(const FlowStep& step, const float* values, const std::uint8_t* freedom,
                            float* next) {
  const D d;
  const Neighbours v{values};
  const std::ptrdiff_t y = step.row;
  const std::ptrdiff_t z = step.slice;
  const V middle = v.at(0);
  const auto slope = [&](std::ptrdiff_t a, float first) {
    return hn::Mul(hn::Set(d, first), hn::Sub(v.at(a), v.at(-a)));
  };
  const auto bend = [&](std::ptrdiff_t a, float second) {
    const V both = hn::Add(v.at(a), v.at(-a));
    return hn::Mul(hn::Set(d, second), hn::NegMulAdd(hn::Set(d, 2), middle, both));
  };
  const V gx = slope(1, step.first.x);
  const V gy = slope(y, step.first.y);
  const V gz = slope(z, step.first.z);
  const V xx = bend(1, step.second.x);
  const V yy = bend(y, step.second.y);
  const V zz = bend(z, step.second.z);
  const V xy = hn::Mul(hn::Set(d, 2 * step.first.x * step.first.y), v.mixed(1, y));
  const V xz = hn::Mul(hn::Set(d, 2 * step.first.x * step.first.z), v.mixed(1, z));
  const V yz = hn::Mul(hn::Set(d, 2 * step.first.y * step.first.z), v.mixed(y, z));
  V squared = hn::Set(d, std::numeric_limits<float>::min());
  squared = hn::MulAdd(gx, gx, hn::MulAdd(gy, gy, hn::MulAdd(gz, gz, squared)));
  // gᵀHg, the mixed ones twice: each row of H times g first.
  const V hx = hn::MulAdd(gx, xx, hn::MulAdd(gy, xy, hn::Mul(gz, xz)));
  const V hy = hn::MulAdd(gy, yy, hn::Mul(gz, yz));
  const V along = hn::MulAdd(gx, hx, hn::MulAdd(gy, hy, hn::Mul(gz, hn::Mul(gz, zz))));
  const V all = hn::Add(xx, hn::Add(yy, zz));
  const V change = hn::NegMulAdd(hn::Set(d, step.normal), hn::Div(along, squared), all);
  const auto bytes = hn::LoadU(hn::Rebind<std::uint8_t, D>(), freedom);
  const V freedoms = hn::ConvertTo(d, hn::PromoteTo(hn::Rebind<std::int32_t, D>(), bytes));
  const V time = hn::Mul(hn::Set(d, step.time), freedoms);
  hn::StoreU(hn::MulAdd(time, change, middle), d, next);
}

}  // namespace

void FlowBlock(const FlowStep& step, const float* values, const std::uint8_t* freedom,
               const IVec3& count, float* next) {
  const auto lanes = static_cast<int>(hn::Lanes(D()));
  for (int z = 0; z < count.z; ++z) {
    for (int y = 0; y < count.y; ++y, next += kFlowBlock) {
      const std::ptrdiff_t first = z * step.slice + y * step.row;
      for (int x = 0; x < count.x; x += lanes) {
        flow_voxels(step, values + first + x, freedom + first + x, next + x);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clipgs {

HWY_EXPORT(FlowBlock);

void flow_block(const FlowStep& step, const float* values, const std::uint8_t* freedom,
                const IVec3& count, float* next) {
  HWY_DYNAMIC_DISPATCH(FlowBlock)(step, values, freedom, count, next);
}

}  // namespace clipgs
#endif
