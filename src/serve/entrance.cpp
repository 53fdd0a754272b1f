#include "serve/entrance.h"

#include <fmt/format.h>
#include <utility>

#include "core/letter_case.h"
#include "serve/http.h"
#include "serve/token.h"

namespace clipgs {

namespace {

namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kCookie = "__Host-clipgs";
constexpr std::string_view kBearer = "Bearer ";
constexpr std::chrono::milliseconds kDelay(2000);

/// Whether a page may have been meant as the secret part of an address: what else is asked for by
/// those who lack it has a dot or a stroke.
bool may_be_token(std::string_view page) {
  return !page.empty() && page.find_first_of("./") == std::string_view::npos;
}

/// What a request brings beside its address; "" if nothing.
std::string_view brought_by(const HttpRequest& request) {
  const std::string_view given = header(request, field::authorization);
  if (is_alike(given.substr(0, kBearer.size()), kBearer)) {
    return given.substr(kBearer.size());
  }
  return cookie(header(request, field::cookie), kCookie);
}

/// On to the same place without the token in its address.
void send_on(const HttpRequest& request, std::string_view token, Answer& answer) {
  answer.head.result(status::found);
  answer.head.set(field::location, "/" + std::string(query_of(request)));
  answer.head.set(field::cache_control, "no-store");
  // Lax, so that a link to a view can be followed from another site: nothing is changed by GET,
  // and what other sites embed or fetch still comes without the cookie.
  answer.head.set(field::set_cookie,
                  fmt::format("{}={}; Path=/; Secure; HttpOnly; SameSite=Lax; Max-Age=31536000",
                              kCookie, written_token(token)));
}

}  // namespace

Entrance::Entrance(std::string token, const std::filesystem::path& tokens)
    : token_(std::move(token)),
      book_(tokens.empty() ? nullptr : std::make_unique<TokenBook>(tokens)) {}

std::optional<Grant> Entrance::admit(const HttpRequest& request, const std::string& path,
                                     const Client& client, Answer& answer) {
  if (is_open()) {
    return Grant{"", {"."}, true, client.is_local};
  }
  const std::string_view brought = brought_by(request);
  const std::string page = path.substr(1);
  std::optional<AccessToken> known = find(brought);
  const bool by_address = !known && may_be_token(page) && (known = find(page));
  if (!known) {
    refuse(client, !brought.empty() || may_be_token(page), answer);
    return std::nullopt;
  }
  answer.token = known->grant.name;
  if (known->is_over()) {
    fail(answer, status::forbidden, "the time of this address is over; ask for another");
    return std::nullopt;
  }
  if (by_address) {
    send_on(request, page, answer);
    return std::nullopt;
  }
  return std::move(known->grant);
}

std::optional<AccessToken> Entrance::find(std::string_view text) {
  if (text.empty()) {
    return std::nullopt;
  }
  if (book_) {
    return book_->find(text);
  }
  return is_same_secret(plain_token(text), plain_token(token_))
             ? std::optional(AccessToken{{"", {"."}, true, true}, "", ""})
             : std::nullopt;
}

void Entrance::refuse(const Client& client, bool tried, Answer& answer) {
  if (tried && throttle_.is_one_too_many(client.network)) {
    answer.delay = kDelay;
    answer.last = true;
    answer.head.set(field::retry_after, "6");
    fail(answer, status::too_many_requests, "too many wrong addresses; wait a little");
  } else if (book_) {
    fail(answer, status::forbidden,
         "open the whole address that you were given, with the letters at its end");
  } else {
    fail(answer, status::forbidden,
         "open the whole address that clipgs serve printed, with the letters at its end");
  }
}

}  // namespace clipgs
