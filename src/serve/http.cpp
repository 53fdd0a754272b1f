#include "serve/http.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace clipgs {

namespace {

std::optional<FileState> state_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  FileState state;
  state.size = static_cast<std::uintmax_t>(status.st_size);
  state.version = fmt::format("{:x}-{:x}-{:x}{:08x}", status.st_size, status.st_ino,
                              status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
  return state;
}

bool is_unreserved(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '.' || c == '_' || c == '~';
}

}  // namespace

std::optional<FileState> file_state(const std::filesystem::path& path) {
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) {
    return std::nullopt;
  }
  return state_of(status);
}

OpenFile::OpenFile(const std::filesystem::path& path) {
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status{};
  if (fd_ < 0 || ::fstat(fd_, &status) != 0) {
    return;
  }
  if (const std::optional<FileState> state = state_of(status)) {
    state_ = *state;
  } else {
    ::close(fd_);
    fd_ = -1;
  }
}

OpenFile::~OpenFile() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

size_t OpenFile::read(std::uintmax_t offset, char* out, size_t size) const {
  size_t done = 0;
  while (done < size) {
    const ssize_t n = ::pread(fd_, out + done, size - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) {
      continue;
    }
    if (n <= 0) {
      break;
    }
    done += static_cast<size_t>(n);
  }
  return done;
}

std::string percent_encode(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (is_unreserved(c)) {
      result += c;
    } else {
      result += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return result;
}

const char* content_type(std::string_view path) {
  constexpr std::array<std::pair<std::string_view, const char*>, 8> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".wasm", "application/wasm"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".webp", "image/webp"},
      {".json", "application/json"},
  }};
  const auto* const type = std::ranges::find_if(
      kTypes, [&](const auto& candidate) { return path.ends_with(candidate.first); });
  return type == kTypes.end() ? "application/octet-stream" : type->second;
}

bool etag_matches(std::string_view header, std::string_view etag) {
  while (!header.empty()) {
    const size_t comma = std::min(header.find(','), header.size());
    std::string_view one = header.substr(0, comma);
    header.remove_prefix(std::min(comma + 1, header.size()));
    while (!one.empty() && one.front() == ' ') {
      one.remove_prefix(1);
    }
    while (!one.empty() && one.back() == ' ') {
      one.remove_suffix(1);
    }
    if (one.starts_with("W/")) {
      one.remove_prefix(2);
    }
    if (one == "*" || one == etag) {
      return true;
    }
  }
  return false;
}

std::optional<ByteRange> satisfiable_range(const std::vector<ByteRange>& ranges,
                                           std::uintmax_t size) {
  const auto end = static_cast<ssize_t>(size);
  if (ranges.size() != 1 || end == 0) {
    return std::nullopt;
  }
  auto [first, last] = ranges.front();
  if (first < 0) {  // the last so many
    if (last <= 0) {
      return std::nullopt;
    }
    return ByteRange{std::max<ssize_t>(0, end - last), end - 1};
  }
  if (last < 0 || last >= end) {
    last = end - 1;
  }
  if (first > last) {
    return std::nullopt;
  }
  return ByteRange{first, last};
}

std::string_view host_name(std::string_view header) {
  if (header.starts_with('[')) {
    const size_t close = header.find(']');
    return close == std::string_view::npos ? header : header.substr(1, close - 1);
  }
  return header.substr(0, header.find(':'));
}

bool is_loopback(std::string_view host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

}  // namespace clipgs
