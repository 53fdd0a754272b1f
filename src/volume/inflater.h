#pragma once

#include <cstdint>
#include <istream>
#include <span>
#include <vector>
#include <zlib.h>

namespace clipgs {

/// Unpacks gzip (one stream or several, one after the other) or zlib data piece by piece, and
/// checks the CRC and the length at their ends.
class Inflater {
 public:
  enum class State {
    kGoing,
    kWhole,    ///< the end was reached and its checks were right
    kCutOff,   ///< the file ends before the packed data do
    kDamaged,  ///< what there is cannot be unpacked
    kMismatch  ///< all was unpacked, but it is not what was packed: CRC or length are wrong
  };

  explicit Inflater(std::istream& packed);  ///< `packed` must outlive it
  ~Inflater();
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Fills `to`; returns how many bytes there were, fewer only if state() is not kGoing any more.
  size_t read(std::span<std::uint8_t> to);
  State state() const { return state_; }

 private:
  bool refill();
  void next_stream();
  void take(int status);

  std::istream& packed_;
  std::vector<std::uint8_t> buffer_;
  z_stream stream_{};
  State state_ = State::kGoing;
};

/// Whether a file that begins so is packed by gzip.
bool begins_gzip(std::span<const std::uint8_t> bytes);

}  // namespace clipgs
