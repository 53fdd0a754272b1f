#include "volume/inflater.h"

#include <algorithm>
#include <limits>
#include <new>
#include <string_view>

namespace clipgs {
namespace {

constexpr size_t kPackedPiece = size_t{1} << 16;
constexpr int kGzipOrZlib = 15 + 32;  // zlib: 32 more finds out which of the two it is

}  // namespace

bool begins_gzip(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

Inflater::Inflater(std::istream& packed) : packed_(packed), buffer_(kPackedPiece) {
  if (inflateInit2(&stream_, kGzipOrZlib) != Z_OK) {
    throw std::bad_alloc();
  }
}

Inflater::~Inflater() { inflateEnd(&stream_); }

/// Whether there is any input.
bool Inflater::refill() {
  if (stream_.avail_in == 0) {
    packed_.read(reinterpret_cast<char*>(buffer_.data()),
                 static_cast<std::streamsize>(kPackedPiece));
    stream_.next_in = buffer_.data();
    stream_.avail_in = static_cast<uInt>(packed_.gcount());
  }
  return stream_.avail_in > 0;
}

/// After one stream another may follow (bgzip, pigz -i, cat of two); anything else is padding.
void Inflater::next_stream() {
  constexpr std::uint8_t kGzipByte = 0x1f;
  if (refill() && *stream_.next_in == kGzipByte) {
    inflateReset2(&stream_, kGzipOrZlib);
  } else {
    state_ = State::kWhole;
  }
}

void Inflater::take(int status) {
  if (status == Z_STREAM_END) {
    next_stream();
  } else if (status != Z_OK && status != Z_BUF_ERROR) {
    const std::string_view why = stream_.msg == nullptr ? "" : stream_.msg;
    const bool checks = why == "incorrect data check" || why == "incorrect length check";
    state_ = checks ? State::kMismatch : State::kDamaged;
  }
}

size_t Inflater::read(std::span<std::uint8_t> to) {
  size_t done = 0;
  while (done < to.size() && state_ == State::kGoing) {
    if (!refill()) {
      state_ = State::kCutOff;
      break;
    }
    const size_t room = std::min<size_t>(to.size() - done, std::numeric_limits<uInt>::max());
    stream_.next_out = &to[done];
    stream_.avail_out = static_cast<uInt>(room);
    take(inflate(&stream_, Z_NO_FLUSH));
    done += room - stream_.avail_out;
  }
  return done;
}

}  // namespace clipgs
