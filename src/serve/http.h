#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace clipgs {

/// The elements of a list in a header, without the blanks around them.
std::vector<std::string_view> header_list(std::string_view list, char separator);

/// MIME type by the ending of a file's name.
const char* content_type(std::string_view path);

/// Whether an If-None-Match header names `etag` (quoted), or says *.
bool etag_matches(std::string_view header, std::string_view etag);

/// How a file is sent, in the order of preference.
enum class Encoding { kBrotli, kGzip, kIdentity };
/// "br", "gzip", "identity".
const char* encoding_name(Encoding encoding);
/// What an Accept-Encoding header (RFC 9110, 12.5.3) likes best of what there is: of `offered` and
/// identity, which it gets in any case where nothing else is accepted.
Encoding choose_encoding(std::string_view header, const std::vector<Encoding>& offered);

/// First and last byte, −1 where the header leaves one out: "bytes=5-", "bytes=-5".
using ByteRange = std::pair<ssize_t, ssize_t>;

/// The ranges of a Range header; none if it is malformed or in other units, which are to be
/// ignored (RFC 9110, 14.2).
std::vector<ByteRange> parse_ranges(std::string_view header);

/// The one range that is asked of `size` bytes, with both ends inside; nothing if no byte of it
/// exists, or if there are several (nobody needs them of a case).
std::optional<ByteRange> satisfiable_range(const std::vector<ByteRange>& ranges,
                                           std::uintmax_t size);

/// Value of the cookie `name` in a Cookie header, or nothing.
std::string_view cookie(std::string_view header, std::string_view name);

/// The host of a Host header, HOST[:PORT] (RFC 9112, 3.2): in lower case, IPv6 addresses without
/// brackets, names without the dot of the root at their end. Nothing if it is not one, as with
/// letters behind an address, with a user's name, or a port that cannot be.
std::optional<std::string> host_name(std::string_view header);

/// Whether `host`, as host_name() gives it, can only be reached from this machine: localhost,
/// which browsers never look up elsewhere, or a loopback address in its usual form.
bool is_loopback(const std::string& host);

}  // namespace clipgs
