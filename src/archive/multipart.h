#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace clipgs {

/// Takes the parts of a message, one after another.
struct PartReceiver {
  std::function<void()> begin;
  std::function<void(std::string_view bytes)> receive;  ///< as often as bytes come
  std::function<void()> end;                            ///< of a part that is whole
};

/// The parts of a multipart message (RFC 2046, 5.1.1), that comes in pieces cut anywhere. Never
/// holds more than the last piece and what may be the beginning of a boundary.
class MultipartReader {
 public:
  static constexpr size_t kLongestBoundary = 256;  ///< bytes; the RFC has 70
  static constexpr size_t kMostHeaders = 16384;    ///< bytes of one part's

  /// `content_type`: of the message, "multipart/related; boundary=…"; `name`: what errors call it.
  /// Throws Error if it is not one.
  MultipartReader(std::string_view content_type, std::string name, PartReceiver receiver);

  /// The next bytes of the message. Throws Error for a message that is broken.
  void read(std::string_view bytes);
  /// Whether the end of the last part was there; what comes after it is passed over.
  bool is_complete() const { return state_ == State::kAfter; }

 private:
  enum class State { kBefore, kHeaders, kPart, kAfter };

  bool step();
  bool find_boundary();
  bool read_headers();
  void pass_on(size_t count);

  std::string name_;
  std::string delimiter_;  ///< with the line's end before it
  PartReceiver receiver_;
  State state_ = State::kBefore;
  std::string pending_ = "\r\n";  ///< the first boundary may have no line before it
};

/// The value of a parameter in a header: "boundary" of "multipart/related; boundary=\"a b\"". ""
/// where there is none.
std::string header_parameter(std::string_view header, std::string_view name);

}  // namespace clipgs
