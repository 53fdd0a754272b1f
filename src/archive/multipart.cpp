#include "archive/multipart.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/letter_case.h"

namespace clipgs {

namespace {

constexpr std::string_view kLineEnd = "\r\n";

bool begins_alike(std::string_view text, std::string_view beginning) {
  return is_alike(text.substr(0, beginning.size()), beginning);
}

std::string_view without_blanks(std::string_view text) {
  const size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(" \t") + 1);
}

/// What stands at the beginning of `text` up to a semicolon outside of quotes; removes both.
std::string_view take_parameter(std::string_view& text) {
  bool quoted = false;
  size_t end = 0;
  while (end < text.size() && (quoted || text[end] != ';')) {
    quoted = quoted != (text[end] == '"');
    ++end;
  }
  const std::string_view parameter = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return without_blanks(parameter);
}

}  // namespace

std::string header_parameter(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::string_view parameter = take_parameter(header);
    const size_t equals = std::min(parameter.find('='), parameter.size());
    const std::string_view key = without_blanks(parameter.substr(0, equals));
    if (key.size() == name.size() && begins_alike(key, name) && equals < parameter.size()) {
      std::string_view value = without_blanks(parameter.substr(equals + 1));
      if (value.size() >= 2 && value.front() == '"' && value.back() == '"') {
        value = value.substr(1, value.size() - 2);
      }
      return std::string(value);
    }
  }
  return "";
}

MultipartReader::MultipartReader(std::string_view content_type, std::string name,
                                 PartReceiver receiver)
    : name_(std::move(name)), receiver_(std::move(receiver)) {
  const std::string boundary = header_parameter(content_type, "boundary");
  if (!begins_alike(content_type, "multipart/") || boundary.empty() ||
      boundary.size() > kLongestBoundary) {
    throw Error("{}: answers no DICOM files; is it the address of DICOMweb?", name_);
  }
  delimiter_ = "\r\n--" + boundary;
}

void MultipartReader::read(std::string_view bytes) {
  if (is_complete()) {
    return;
  }
  pending_ += bytes;
  while (step()) {
  }
}

/// Goes on by one boundary or head; false where more bytes are needed for it.
bool MultipartReader::step() {
  switch (state_) {
    case State::kBefore:
    case State::kPart:
      return find_boundary();
    case State::kHeaders:
      return read_headers();
    case State::kAfter:
      pending_.clear();
      return false;
  }
  return false;
}

/// Hands the first bytes that are pending to the part that they belong to.
void MultipartReader::pass_on(size_t count) {
  if (count > 0 && state_ == State::kPart) {
    receiver_.receive({pending_.data(), count});
  }
  pending_.erase(0, count);
}

/// Up to a boundary and the end of its line, or to what may become one.
bool MultipartReader::find_boundary() {
  const size_t at = pending_.find(delimiter_);
  if (at == std::string::npos) {
    pass_on(pending_.size() - std::min(pending_.size(), delimiter_.size() - 1));
    return false;
  }
  pass_on(at);
  size_t after = delimiter_.size();
  const bool is_last = pending_.compare(after, 2, "--") == 0;
  while (after < pending_.size() && (pending_[after] == ' ' || pending_[after] == '\t')) {
    ++after;
  }
  if (!is_last && pending_.size() - after < kLineEnd.size()) {
    if (after - delimiter_.size() > kLongestBoundary) {
      throw Error("{}: its answer is broken (a boundary without an end); try again", name_);
    }
    return false;
  }
  if (!is_last && pending_.compare(after, kLineEnd.size(), kLineEnd) != 0) {
    pass_on(kLineEnd.size());  // it only begins as the boundary does
    return true;
  }
  if (state_ == State::kPart) {
    receiver_.end();
  }
  state_ = is_last ? State::kAfter : State::kHeaders;
  pending_.erase(0, after);  // the line's end stays: it ends an empty head
  return true;
}

/// Passes over a part's headers.
bool MultipartReader::read_headers() {
  constexpr std::string_view kEnd = "\r\n\r\n";
  const size_t end = pending_.find(kEnd);
  if (end == std::string::npos) {
    if (pending_.size() > kMostHeaders) {
      throw Error("{}: its answer is broken (headers without an end); try again", name_);
    }
    return false;
  }
  pending_.erase(0, end + kEnd.size());
  state_ = State::kPart;
  receiver_.begin();
  return true;
}

}  // namespace clipgs
