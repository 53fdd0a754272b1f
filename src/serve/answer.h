#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "asset/zip.h"

namespace clipgs {

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;
using HttpHead = boost::beast::http::response<boost::beast::http::empty_body>;

/// What a request is answered.
struct Answer {
  HttpHead head;
  ByteSource body;  ///< may be read from any thread
  /// Before it is sent: who tries what is wrong again and again has time.
  std::chrono::milliseconds delay{0};
  /// The connection ends with it.
  bool last = false;
  /// Whose token the request brought, as it is called; "": no named one.
  std::string token;
};

/// Of a request; "" where it has none of that name.
std::string_view header(const HttpRequest& request, boost::beast::http::field name);

/// The address that is asked for, and of it the query, "?..." or "".
std::string_view target_of(const HttpRequest& request);
std::string_view query_of(const HttpRequest& request);

/// Whether a request with a body of that MIME type comes from this server's own pages: `type` is
/// one that pages elsewhere cannot send without asking first, which this server never answers.
bool is_from_own_page(const HttpRequest& request, std::string_view type);

/// Bytes that live as long as the program, or as `owner`.
ByteSource source_of(std::string_view bytes, std::shared_ptr<const void> owner = nullptr);

/// Whether the browser already has what `etag` names; then it is told so.
bool not_modified(const HttpRequest& request, Answer& answer, const std::string& etag);

/// Answers with a text of that MIME type, which no browser keeps.
void give_text(Answer& answer, boost::beast::http::status status, const char* type,
               std::string text);
/// Answers with a line for a person.
void fail(Answer& answer, boost::beast::http::status status, const std::string& message);

}  // namespace clipgs
