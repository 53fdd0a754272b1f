#include "serve/http.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <cstring>
#include <map>
#include <netinet/in.h>

#include "core/letter_case.h"
#include "core/percent.h"

namespace clipgs {

namespace {

/// Takes the first element, without the blanks around it, off a list in a header.
std::string_view next_of_list(std::string_view& list, char separator) {
  const size_t end = std::min(list.find(separator), list.size());
  std::string_view one = list.substr(0, end);
  list.remove_prefix(std::min(end + 1, list.size()));
  constexpr std::string_view kBlanks = " \t";
  one.remove_prefix(std::min(one.find_first_not_of(kBlanks), one.size()));
  return one.substr(0, one.find_last_not_of(kBlanks) + 1);
}

/// A whole number without a sign; nothing if it is none, or too large.
std::optional<ssize_t> number(std::string_view text) {
  ssize_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.starts_with('-')) {
    return std::nullopt;
  }
  return value;
}

/// Of an encoding's parameters, "q=0.5": 1 if it is not said, 0 if it is not understood.
float quality(std::string_view parameters) {
  while (!parameters.empty()) {
    const std::string one = lower_case(next_of_list(parameters, ';'));
    if (one.starts_with("q=")) {
      float value = 0;
      const char* const end = one.data() + one.size();
      const auto read = std::from_chars(one.data() + 2, end, value, std::chars_format::fixed);
      return read.ec == std::errc() && read.ptr == end && value >= 0 && value <= 1 ? value : 0;
    }
  }
  return 1;
}

/// Whether `rest` is what may follow a host: nothing, or a colon and a port.
bool is_port(std::string_view rest) {
  constexpr int kMaxPort = 65535;
  if (rest.empty() || rest == ":") {
    return true;
  }
  const std::optional<ssize_t> port = number(rest.substr(1));
  return rest.front() == ':' && port && *port <= kMaxPort;
}

bool is_loopback_v4(const in_addr& address) {
  constexpr std::uint32_t kNetwork = 127;
  return ntohl(address.s_addr) >> 24 == kNetwork;
}

}  // namespace

std::vector<std::string_view> header_list(std::string_view list, char separator) {
  std::vector<std::string_view> elements;
  while (!list.empty()) {
    elements.push_back(next_of_list(list, separator));
  }
  return elements;
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
    std::string_view one = next_of_list(header, ',');
    if (one.starts_with("W/")) {
      one.remove_prefix(2);
    }
    if (one == "*" || one == etag) {
      return true;
    }
  }
  return false;
}

const char* encoding_name(Encoding encoding) {
  switch (encoding) {
    case Encoding::kBrotli:
      return "br";
    case Encoding::kGzip:
      return "gzip";
    case Encoding::kIdentity:
      break;
  }
  return "identity";
}

Encoding choose_encoding(std::string_view header, const std::vector<Encoding>& offered) {
  std::map<std::string, float> weights;
  while (!header.empty()) {
    std::string_view parameters = next_of_list(header, ',');
    const std::string name = lower_case(next_of_list(parameters, ';'));
    weights[name == "x-gzip" ? "gzip" : name] = quality(parameters);
  }
  const auto weight = [&](Encoding encoding) {
    const auto named = weights.find(encoding_name(encoding));
    const auto any = weights.find("*");
    // Nobody who asks for an encoding would rather have none, unless it is said.
    constexpr float kUnsaid = 1e-6f;
    const float otherwise = encoding == Encoding::kIdentity ? kUnsaid : 0;
    return named != weights.end() ? named->second : any != weights.end() ? any->second : otherwise;
  };
  Encoding best = Encoding::kIdentity;
  float most = 0;
  for (const Encoding one : {Encoding::kBrotli, Encoding::kGzip, Encoding::kIdentity}) {
    const bool there = one == Encoding::kIdentity || std::ranges::count(offered, one) > 0;
    if (there && weight(one) > most) {
      best = one;
      most = weight(one);
    }
  }
  return best;
}

std::vector<ByteRange> parse_ranges(std::string_view header) {
  constexpr std::string_view kUnit = "bytes=";
  if (!lower_case(header.substr(0, kUnit.size())).starts_with(kUnit)) {
    return {};
  }
  header.remove_prefix(kUnit.size());
  std::vector<ByteRange> ranges;
  while (!header.empty()) {
    std::string_view last = next_of_list(header, ',');
    const bool dash = last.find('-') != std::string_view::npos;
    const std::string_view first = next_of_list(last, '-');
    const std::optional<ssize_t> begin = first.empty() ? -1 : number(first);
    const std::optional<ssize_t> end = last.empty() ? -1 : number(last);
    if (!dash || !begin || !end || (first.empty() && last.empty()) ||
        (*begin >= 0 && *end >= 0 && *begin > *end)) {
      return {};
    }
    ranges.emplace_back(*begin, *end);
  }
  return ranges;
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

std::string_view cookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::string_view one = next_of_list(header, ';');
    if (one.starts_with(name) && one.substr(name.size()).starts_with('=')) {
      return one.substr(name.size() + 1);
    }
  }
  return {};
}

std::optional<std::string> host_name(std::string_view header) {
  const bool v6 = header.starts_with('[');
  const size_t end = v6 ? header.find(']') : header.find(':');
  if (v6 && end == std::string_view::npos) {
    return std::nullopt;
  }
  std::string host = lower_case(v6 ? header.substr(1, end - 1) : header.substr(0, end));
  const std::string_view rest =
      v6 ? header.substr(end + 1) : header.substr(std::min(end, header.size()));
  if (!is_port(rest)) {
    return std::nullopt;
  }
  if (v6) {
    in6_addr address{};
    return inet_pton(AF_INET6, host.c_str(), &address) == 1 ? std::optional(host) : std::nullopt;
  }
  if (host.ends_with('.')) {
    host.pop_back();
  }
  if (host.empty() || !std::ranges::all_of(host, is_unreserved)) {
    return std::nullopt;
  }
  return host;
}

bool is_loopback(const std::string& host) {
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) {
    return is_loopback_v4(v4);
  }
  in6_addr v6{};
  if (inet_pton(AF_INET6, host.c_str(), &v6) == 1) {
    if (!IN6_IS_ADDR_V4MAPPED(&v6)) {
      return IN6_IS_ADDR_LOOPBACK(&v6);
    }
    std::memcpy(&v4, &v6.s6_addr[12], sizeof(v4));
    return is_loopback_v4(v4);
  }
  return host == "localhost";
}

}  // namespace clipgs
