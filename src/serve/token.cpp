#include "serve/token.h"

#include <array>
#include <openssl/crypto.h>
#include <openssl/rand.h>

#include "core/digest.h"
#include "core/error.h"

namespace clipgs {

namespace {

/// None that is mistaken for another one.
constexpr std::string_view kLetters = "abcdefghijkmnpqrstuvwxyz23456789";
static_assert(kLetters.size() == 32, "5 bits a letter");
constexpr size_t kTokenLetters = 26;
constexpr size_t kGroup = 5;
constexpr size_t kGroups = kTokenLetters / kGroup;  // the last one has a letter more

}  // namespace

std::string make_token() {
  std::array<unsigned char, kTokenLetters> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw Error("a token cannot be made: OpenSSL has no random numbers; is it up to date?");
  }
  std::string letters;
  for (const unsigned char byte : bytes) {
    letters += kLetters[byte % kLetters.size()];
  }
  return written_token(letters);
}

bool is_token(const std::string& text) {
  const std::string letters = plain_token(text);
  return letters.size() == kTokenLetters && written_token(letters) == text &&
         letters.find_first_not_of(kLetters) == std::string::npos;
}

std::string plain_token(std::string_view text) {
  std::string letters;
  for (const char c : text) {
    if (c != '-') {
      letters += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  return letters;
}

std::string written_token(std::string_view text) {
  const std::string letters = plain_token(text);
  std::string token;
  for (size_t i = 0; i < letters.size(); ++i) {
    const bool begins = i > 0 && i % kGroup == 0 && i / kGroup < kGroups;
    token += begins ? "-" : "";
    token += letters[i];
  }
  return token;
}

std::string token_digest(std::string_view text) {
  const std::string letters = plain_token(text);
  return Digest().add_bytes(letters.data(), letters.size()).hex();
}

bool is_same_secret(std::string_view given, std::string_view secret) {
  return given.size() == secret.size() &&
         CRYPTO_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

}  // namespace clipgs
