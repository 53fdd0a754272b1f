#pragma once

#include <string>
#include <string_view>

namespace clipgs {

/// A new secret part of an address: 26 letters and digits, 130 bits, in groups for those who type
/// them: "k3v9q-txw7h-…". Throws Error.
std::string make_token();

/// Whether it is one, as make_token() writes it.
bool is_token(const std::string& text);

/// A token as people may type it, in capitals or without its strokes, in the form that is compared.
std::string plain_token(std::string_view text);
/// The same as make_token() writes it.
std::string written_token(std::string_view text);

/// SHA-256 of its plain form, 64 hexadecimal digits: what is kept in place of it.
std::string token_digest(std::string_view text);

/// Takes the same time wherever they differ.
bool is_same_secret(std::string_view given, std::string_view secret);

}  // namespace clipgs
