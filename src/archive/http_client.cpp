#include "archive/http_client.h"

#include <algorithm>
#include <exception>
#include <thread>

#include "archive/http_connection.h"
#include "archive/http_lines.h"

namespace clipgs {

namespace {

constexpr int kMostRedirects = 5;

/// Without what only the archive itself may know.
HttpOptions anonymous(const HttpOptions& options) {
  HttpOptions others = options;
  others.token.clear();
  others.user.clear();
  others.password.clear();
  others.certificate.clear();
  others.key.clear();
  return others;
}

[[noreturn]] void fail(const HttpOutcome& outcome, const Url& url, const std::string& line) {
  const bool has_status = outcome.status / 100 != 2;
  throw HttpError(has_status ? outcome.status : 0, fmt::format("{}: {}", url.place(), line));
}

/// Where an answer leads to. Throws HttpError where that is less safe.
Url next_place(const HttpOutcome& outcome, const Url& url) {
  Url next = redirected(url, outcome.location);
  if (url.tls && !next.tls) {
    fail(outcome, url,
         "leads to an address that is not encrypted (http); give the one that it has in the end");
  }
  return next;
}

}  // namespace

HttpClient::HttpClient(const std::string& base, const HttpOptions& options)
    : base_(parse_url(base)), options_(options) {
  if (options.certificate.empty() != options.key.empty()) {
    throw Error("--client-certificate and --client-key belong together; give both");
  }
  while (base_.path.ends_with('/')) {
    base_.path.pop_back();
  }
  connection_ = std::make_unique<HttpConnection>(base_, options_);
}

HttpClient::~HttpClient() = default;

std::string HttpClient::place() const { return base_.place(); }

/// At one place, as often as that makes sense.
HttpOutcome HttpClient::ask(HttpConnection& connection, const OutgoingRequest& request,
                            const HttpReceiver& receiver) const {
  const bool may_repeat = std::string_view(request.method) != "POST";
  std::chrono::milliseconds wait = options_.first_wait;
  for (int attempt = 1;; ++attempt) {
    HttpOutcome outcome = connection.send(request, receiver);
    if (outcome.thrown) {
      std::rethrow_exception(outcome.thrown);
    }
    if (!may_repeat || attempt >= options_.attempts || !outcome.may_pass(connection.url())) {
      return outcome;
    }
    std::this_thread::sleep_for(outcome.retry_after.value_or(wait));
    wait = std::min(2 * wait, kLongestWait);
  }
}

void HttpClient::send(OutgoingRequest request, const HttpReceiver& receiver) {
  const bool follows = std::string_view(request.method) == "GET";
  request.path.insert(0, base_.path);
  std::unique_ptr<HttpConnection> elsewhere;
  for (int redirects = 0; redirects <= kMostRedirects; ++redirects) {
    HttpConnection& connection = elsewhere ? *elsewhere : *connection_;
    const HttpOutcome outcome = ask(connection, request, receiver);
    if (outcome.is_success()) {
      return;
    }
    if (!follows || !outcome.is_redirect()) {
      fail(outcome, connection.url(), line_of(outcome, connection.url(), options_));
    }
    const Url next = next_place(outcome, connection.url());
    request.path = next.path;
    elsewhere = next.is_same_place(base_)
                    ? nullptr
                    : std::make_unique<HttpConnection>(next, anonymous(options_));
  }
  throw HttpError(
      0, fmt::format("{}: leads from one address to the next; check the address", place()));
}

HttpAnswer HttpClient::answer_to(OutgoingRequest request, std::uint64_t most) {
  HttpAnswer answer;
  send(std::move(request), {[&](const AnswerHead& head) { answer = {head, {}}; },
                            [&](std::string_view bytes) {
                              if (bytes.size() > most - answer.body.size()) {
                                throw HttpError(
                                    0, fmt::format("{}: answers more than {} bytes; is it the "
                                                   "right address?",
                                                   place(), most));
                              }
                              answer.body += bytes;
                            }});
  return answer;
}

HttpAnswer HttpClient::get(const std::string& path, const std::string& accept, std::uint64_t most) {
  return answer_to({"GET", path, accept}, most);
}

void HttpClient::get(const std::string& path, const std::string& accept,
                     const HttpReceiver& receiver) {
  send({"GET", path, accept}, receiver);
}

HttpAnswer HttpClient::post(const std::string& path, const HttpBody& body, std::uint64_t most) {
  return answer_to({"POST", path, "*/*", body}, most);
}

HttpAnswer HttpClient::put(const std::string& path, const HttpBody& body, std::uint64_t most) {
  return answer_to({"PUT", path, "*/*", body}, most);
}

HttpAnswer HttpClient::del(const std::string& path, std::uint64_t most) {
  return answer_to({"DELETE", path}, most);
}

}  // namespace clipgs
