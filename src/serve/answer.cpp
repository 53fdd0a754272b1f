#include "serve/answer.h"

#include <algorithm>
#include <utility>

#include "serve/http.h"

namespace clipgs {

namespace http = boost::beast::http;
using http::field;

std::string_view header(const HttpRequest& request, field name) {
  const auto text = request[name];
  return {text.data(), text.size()};
}

std::string_view target_of(const HttpRequest& request) {
  return {request.target().data(), request.target().size()};
}

std::string_view query_of(const HttpRequest& request) {
  const std::string_view target = target_of(request);
  return target.substr(std::min(target.find('?'), target.size()));
}

bool is_from_own_page(const HttpRequest& request, std::string_view type) {
  const auto site = request["Sec-Fetch-Site"];
  return header(request, field::content_type) == type && (site.empty() || site == "same-origin");
}

ByteSource source_of(std::string_view bytes, std::shared_ptr<const void> owner) {
  return {bytes.size(),
          [bytes, owner = std::move(owner)](std::uint64_t offset, std::span<std::uint8_t> out) {
            const std::string_view rest = bytes.substr(std::min<size_t>(offset, bytes.size()));
            const size_t size = std::min(rest.size(), out.size());
            std::copy_n(rest.begin(), size, out.begin());
            return size;
          }};
}

bool not_modified(const HttpRequest& request, Answer& answer, const std::string& etag) {
  answer.head.set(field::etag, etag);
  if (!etag_matches(header(request, field::if_none_match), etag)) {
    return false;
  }
  answer.head.result(http::status::not_modified);
  return true;
}

void give_text(Answer& answer, http::status status, const char* type, std::string text) {
  const auto owner = std::make_shared<const std::string>(std::move(text));
  answer.head.result(status);
  answer.head.set(field::content_type, type);
  answer.head.set(field::cache_control, "no-store");
  answer.body = source_of(*owner, owner);
}

void fail(Answer& answer, http::status status, const std::string& message) {
  give_text(answer, status, "text/plain; charset=utf-8", message + "\n");
}

}  // namespace clipgs
