#include "serve/overview_desk.h"

#include <array>
#include <fmt/format.h>
#include <memory>
#include <openssl/evp.h>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "measure/overview_page.h"
#include "serve/http.h"
#include "serve/open_file.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kHome = "/overview";
constexpr std::string_view kPrefix = "/overview/";

/// As a Content-Security-Policy names a script that it lets run.
std::string sha256_of(std::string_view text) {
  std::array<unsigned char, 32> digest{};
  std::array<unsigned char, 45> base64{};
  if (EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1) {
    throw Error("OpenSSL cannot compute SHA-256");
  }
  EVP_EncodeBlock(base64.data(), digest.data(), digest.size());
  return fmt::format("sha256-{}", reinterpret_cast<const char*>(base64.data()));
}

bool is_given(std::string_view name) {
  return !name.starts_with('.') &&
         name.find_first_of(std::string_view("/\0", 2)) == std::string_view::npos &&
         (name.ends_with(".html") || name.ends_with(".webp"));
}

}  // namespace

OverviewDesk::OverviewDesk(fs::path folder)
    : folder_(std::move(folder)),
      policy_(fmt::format("default-src 'none'; script-src '{}'; style-src 'unsafe-inline'; img-src "
                          "'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors "
                          "'self'",
                          sha256_of(overview_script()))) {}

bool OverviewDesk::is_asked(std::string_view path) {
  return path == kHome || path.starts_with(kPrefix);
}

void OverviewDesk::answer(const HttpRequest& request, std::string_view path, Answer& answer) const {
  if (path == kHome) {  // what lies beside the page is asked for from its folder
    answer.head.set(field::location, std::string(kPrefix));
    answer.head.result(status::moved_permanently);
    return;
  }
  const std::string name(path == kPrefix ? "index.html" : path.substr(kPrefix.size()));
  const fs::path pages = folder_ / "overview";
  std::error_code error;
  if (folder_.empty() || !is_given(name) || !fs::exists(pages / name, error)) {
    fail(answer, status::not_found,
         "there is no such page; clipgs overview FOLDER makes one of all cases");
    return;
  }
  const auto file =
      std::make_shared<const OpenFile>(pages / name, fs::canonical(folder_, error) / "overview");
  const std::string etag = '"' + file->state().version + '"';
  answer.head.set(field::cache_control, "no-cache");
  answer.head.set("Content-Security-Policy", policy_);
  answer.head.set(field::etag, etag);
  if (etag_matches(header(request, field::if_none_match), etag)) {
    answer.head.result(status::not_modified);
    return;
  }
  answer.head.set(field::content_type, content_type(name));
  answer.body = {file->state().size, [file](std::uint64_t offset, std::span<std::uint8_t> out) {
                   return file->read(offset, out);
                 }};
}

}  // namespace clipgs
