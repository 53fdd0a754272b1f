// Vectors of one instruction set with the operators of arithmetic, so that kernels read like the
// formulas that they compute. Included once per instruction set, after Highway's foreach_target.h.
#if defined(CLIPGS_CINEMA_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CLIPGS_CINEMA_LANES_INL_H
#undef CLIPGS_CINEMA_LANES_INL_H
#else
#define CLIPGS_CINEMA_LANES_INL_H
#endif

#include <cstdint>
#include <cstring>
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "core/geometry.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace lanes {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::Rebind<std::int32_t, FloatTag>;
using UintTag = hn::Rebind<std::uint32_t, FloatTag>;

/// The most lanes that any instruction set has.
constexpr size_t kMost = 16;
HWY_INLINE size_t count() { return hn::Lanes(FloatTag()); }

struct Mask {
  hn::Mask<FloatTag> m;
};
HWY_INLINE Mask operator&(Mask a, Mask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE Mask operator|(Mask a, Mask b) { return {hn::Or(a.m, b.m)}; }
HWY_INLINE Mask operator~(Mask a) { return {hn::Not(a.m)}; }
/// The first n lanes.
HWY_INLINE Mask first(size_t n) { return {hn::FirstN(FloatTag(), n)}; }
HWY_INLINE Mask none() { return first(0); }
HWY_INLINE bool any(Mask a) { return !hn::AllFalse(FloatTag(), a.m); }
HWY_INLINE size_t how_many(Mask a) { return hn::CountTrue(FloatTag(), a.m); }
/// Bit i is lane i.
HWY_INLINE std::uint32_t bits(Mask a) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(FloatTag(), a.m, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U;
}

struct Float {
  hn::Vec<FloatTag> v;
  Float() = default;
  HWY_INLINE Float(hn::Vec<FloatTag> raw) : v(raw) {}           // NOLINT(*-explicit-*)
  HWY_INLINE Float(float all) : v(hn::Set(FloatTag(), all)) {}  // NOLINT(*-explicit-*)
};
HWY_INLINE Float operator+(Float a, Float b) { return hn::Add(a.v, b.v); }
HWY_INLINE Float operator-(Float a, Float b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Float operator*(Float a, Float b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Float operator/(Float a, Float b) { return hn::Div(a.v, b.v); }
HWY_INLINE Float operator-(Float a) { return hn::Neg(a.v); }
HWY_INLINE Mask operator<(Float a, Float b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE Mask operator<=(Float a, Float b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE Mask operator>(Float a, Float b) { return b < a; }
HWY_INLINE Mask operator>=(Float a, Float b) { return b <= a; }
HWY_INLINE Float min(Float a, Float b) { return hn::Min(a.v, b.v); }
HWY_INLINE Float max(Float a, Float b) { return hn::Max(a.v, b.v); }
HWY_INLINE Float abs(Float a) { return hn::Abs(a.v); }
HWY_INLINE Float sqrt(Float a) { return hn::Sqrt(a.v); }
HWY_INLINE Float log(Float a) { return hn::Log(FloatTag(), a.v); }
HWY_INLINE Float sin(Float a) { return hn::Sin(FloatTag(), a.v); }
HWY_INLINE Float cos(Float a) { return hn::Cos(FloatTag(), a.v); }
/// a with the sign of `sign`.
HWY_INLINE Float copy_sign(Float a, Float sign) { return hn::CopySign(a.v, sign.v); }
HWY_INLINE Float select(Mask where, Float yes, Float no) {
  return hn::IfThenElse(where.m, yes.v, no.v);
}
HWY_INLINE Float or_zero(Mask where, Float yes) { return hn::IfThenElseZero(where.m, yes.v); }

struct Int {
  hn::Vec<IntTag> v;
  Int() = default;
  HWY_INLINE Int(hn::Vec<IntTag> raw) : v(raw) {}                  // NOLINT(*-explicit-*)
  HWY_INLINE Int(std::int32_t all) : v(hn::Set(IntTag(), all)) {}  // NOLINT(*-explicit-*)
};
HWY_INLINE Int operator+(Int a, Int b) { return hn::Add(a.v, b.v); }
HWY_INLINE Int operator-(Int a, Int b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Int operator*(Int a, Int b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Int operator&(Int a, Int b) { return hn::And(a.v, b.v); }
HWY_INLINE Int operator|(Int a, Int b) { return hn::Or(a.v, b.v); }
HWY_INLINE Int min(Int a, Int b) { return hn::Min(a.v, b.v); }
HWY_INLINE Int max(Int a, Int b) { return hn::Max(a.v, b.v); }
template <int kBits>
HWY_INLINE Int shift_left(Int a) {
  return hn::ShiftLeft<kBits>(a.v);
}
template <int kBits>
HWY_INLINE Int shift_right(Int a) {
  return hn::ShiftRight<kBits>(a.v);
}
HWY_INLINE Mask equal(Int a, Int b) { return {hn::RebindMask(FloatTag(), hn::Eq(a.v, b.v))}; }
HWY_INLINE Int select(Mask where, Int yes, Int no) {
  return hn::IfThenElse(hn::RebindMask(IntTag(), where.m), yes.v, no.v);
}

struct Uint {
  hn::Vec<UintTag> v;
  Uint() = default;
  HWY_INLINE Uint(hn::Vec<UintTag> raw) : v(raw) {}                   // NOLINT(*-explicit-*)
  HWY_INLINE Uint(std::uint32_t all) : v(hn::Set(UintTag(), all)) {}  // NOLINT(*-explicit-*)
};
HWY_INLINE Uint operator+(Uint a, Uint b) { return hn::Add(a.v, b.v); }
HWY_INLINE Uint operator*(Uint a, Uint b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Uint operator^(Uint a, Uint b) { return hn::Xor(a.v, b.v); }
HWY_INLINE Uint operator&(Uint a, Uint b) { return hn::And(a.v, b.v); }
HWY_INLINE Uint operator|(Uint a, Uint b) { return hn::Or(a.v, b.v); }
HWY_INLINE Uint operator>>(Uint a, Uint b) { return hn::Shr(a.v, b.v); }
template <int kBits>
HWY_INLINE Uint shift_right(Uint a) {
  return hn::ShiftRight<kBits>(a.v);
}
template <int kBits>
HWY_INLINE Uint swap_groups(Uint a, std::uint32_t low) {
  const Uint down = hn::ShiftRight<kBits>(a.v);
  const Uint up = hn::ShiftLeft<kBits>((a & Uint(low)).v);
  return (down & Uint(low)) | up;
}
HWY_INLINE Uint reverse_bits(Uint a) {
  a = swap_groups<1>(a, 0x55555555U);
  a = swap_groups<2>(a, 0x33333333U);
  a = swap_groups<4>(a, 0x0f0f0f0fU);
  a = swap_groups<8>(a, 0x00ff00ffU);
  return swap_groups<16>(a, 0x0000ffffU);
}
HWY_INLINE Uint select(Mask where, Uint yes, Uint no) {
  return hn::IfThenElse(hn::RebindMask(UintTag(), where.m), yes.v, no.v);
}

HWY_INLINE Float to_float(Int a) { return hn::ConvertTo(FloatTag(), a.v); }
/// Towards zero; of numbers that fit.
HWY_INLINE Int truncate(Float a) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  // ConvertTo also mends what does not fit. All lanes by a mask: GCC warns of the form without one.
  return hn::Vec<IntTag>{_mm512_maskz_cvttps_epi32(0xffff, a.v.raw)};
#else
  return hn::ConvertTo(IntTag(), a.v);
#endif
}
HWY_INLINE Int as_int(Uint a) { return hn::BitCast(IntTag(), a.v); }
HWY_INLINE Uint as_uint(Int a) { return hn::BitCast(UintTag(), a.v); }
HWY_INLINE Float as_float(Int a) { return hn::BitCast(FloatTag(), a.v); }
/// The upper 24 bits as a fraction in [0, 1).
HWY_INLINE Float to_unit(Uint a) { return to_float(as_int(shift_right<8>(a))) * 0x1p-24f; }

// `from` and `to` have count() elements and any alignment.
HWY_INLINE Float load(const float* from) { return hn::LoadU(FloatTag(), from); }
HWY_INLINE Int load(const std::int32_t* from) { return hn::LoadU(IntTag(), from); }
HWY_INLINE Uint load(const std::uint32_t* from) { return hn::LoadU(UintTag(), from); }
HWY_INLINE void store(Float a, float* to) { hn::StoreU(a.v, FloatTag(), to); }
HWY_INLINE void store(Int a, std::int32_t* to) { hn::StoreU(a.v, IntTag(), to); }
HWY_INLINE void store(Uint a, std::uint32_t* to) { hn::StoreU(a.v, UintTag(), to); }
/// Stores the lanes of `where` side by side; may write count() elements.
HWY_INLINE void pack(Float a, Mask where, float* to) {
  hn::StoreU(hn::Compress(a.v, where.m), FloatTag(), to);
}
HWY_INLINE void pack(Uint a, Mask where, std::uint32_t* to) {
  hn::StoreU(hn::Compress(a.v, hn::RebindMask(UintTag(), where.m)), UintTag(), to);
}

HWY_INLINE Float gather(const float* table, Int index) {
  return hn::GatherIndex(FloatTag(), table, index.v);
}
HWY_INLINE Int gather(const std::int32_t* table, Int index) {
  return hn::GatherIndex(IntTag(), table, index.v);
}
HWY_INLINE Uint gather(const std::uint32_t* table, Int index) {
  return hn::GatherIndex(UintTag(), table, index.v);
}
/// Two neighbours of a table of 16-bit numbers, the first in the lower half. Any index is right: it
/// is scaled in 64 bits, so that tables reach 2^31 numbers to either side of `table`.
HWY_INLINE Uint gather_pair(const std::uint16_t* table, Int index) {
  // Highway's gathers take steps of four bytes, or offsets in bytes that reach half as far.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  return hn::Vec<UintTag>{
      _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), 0xffff, index.v.raw, table, 2)};
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  return hn::Vec<UintTag>{
      _mm256_i32gather_epi32(reinterpret_cast<const int*>(table), index.v.raw, 2)};
#else
  alignas(64) std::int32_t at[kMost];
  alignas(64) std::uint32_t pairs[kMost];
  hn::StoreU(index.v, IntTag(), at);
  for (size_t i = 0; i < count(); ++i) {
    std::memcpy(&pairs[i], table + at[i], sizeof pairs[i]);
  }
  return hn::LoadU(UintTag(), pairs);
#endif
}

/// The byte at each index; reads the three after it.
HWY_INLINE Int gather_byte(const std::uint8_t* table, Int index) {
  const Uint four =
      hn::GatherOffset(UintTag(), reinterpret_cast<const std::uint32_t*>(table), index.v);
  return as_int(four) & Int(0xff);
}

/// count() vectors in space or linear RGB.
struct Float3 {
  Float x, y, z;
  Float3() = default;
  HWY_INLINE Float3(Float a, Float b, Float c) : x(a), y(b), z(c) {}
  HWY_INLINE Float3(const Vec3& all) : x(all.x), y(all.y), z(all.z) {}  // NOLINT(*-explicit-*)
};
HWY_INLINE Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Float3 operator-(Float3 a) { return {-a.x, -a.y, -a.z}; }
HWY_INLINE Float3 operator*(Float3 a, Float3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
HWY_INLINE Float3 operator*(Float a, Float3 b) { return {a * b.x, a * b.y, a * b.z}; }
HWY_INLINE Float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Float3 cross(Float3 a, Float3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE Float3 normalize(Float3 a) { return (Float(1) / sqrt(dot(a, a))) * a; }
HWY_INLINE Float largest(Float3 a) { return max(a.x, max(a.y, a.z)); }
HWY_INLINE Float3 select(Mask where, Float3 yes, Float3 no) {
  return {select(where, yes.x, no.x), select(where, yes.y, no.y), select(where, yes.z, no.z)};
}
HWY_INLINE Float3 or_zero(Mask where, Float3 yes) {
  return {or_zero(where, yes.x), or_zero(where, yes.y), or_zero(where, yes.z)};
}
/// See the function of this name in core/geometry.h.
HWY_INLINE void orthonormal_basis(Float3 n, Float3& tangent, Float3& bitangent) {
  const Float sign = copy_sign(1, n.z);
  const Float a = Float(-1) / (sign + n.z);
  const Float b = n.x * n.y * a;
  tangent = {Float(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace lanes
}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#endif
