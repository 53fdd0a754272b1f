// libFuzzer's entry to messages of several parts: after a byte that says how long the pieces are in
// which it comes and a line with its type comes the message. Parts are the same in one piece.
#include <cstdlib>
#include <string>
#include <vector>

#include "archive/multipart.h"

#include "core/fuzz.h"

namespace clipgs::fuzz {

namespace {

struct Message {
  std::vector<std::string> parts;
  size_t ended = 0;
  bool complete = false;
};

Message read_in_pieces(std::string_view type, std::string_view text, size_t piece) {
  Message message;
  MultipartReader reader(
      type, "input",
      {[&] { message.parts.emplace_back(); },
       [&](std::string_view bytes) { message.parts.back() += bytes; }, [&] { ++message.ended; }});
  for (size_t at = 0; at < text.size(); at += piece) {
    reader.read(text.substr(at, piece));
  }
  message.complete = reader.is_complete();
  return message;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> inputs;
  for (const char* message :
       {"\1multipart/related; boundary=ab\n--ab\r\nContent-Type: application/dicom\r\n\r\none\r\n"
        "--ab\r\n\r\ntwo\r\n--ab--\r\n",
        "\7multipart/related; type=\"a;b\"; boundary=\"a b\"\nbefore\r\n--a "
        "b\r\n\r\n\r\n--a\r\n--a b--",
        "\2text/html\n<html>"}) {
    inputs.push_back(bytes_of(message));
  }
  return inputs;
}

void read(std::span<const std::uint8_t> input) {
  const std::string text = text_of(input);
  const size_t line = text.find('\n');
  if (text.empty() || line == std::string::npos || line == 0) {
    return;
  }
  const std::string_view type = std::string_view(text).substr(1, line - 1);
  const std::string_view rest = std::string_view(text).substr(line + 1);
  const size_t piece = 1 + static_cast<unsigned char>(text.front());
  const Message some = read_in_pieces(type, rest, piece);
  // Limits hold what is pending: one long piece may be too much where many short ones are not.
  const Message others = read_in_pieces(type, rest, 1);
  if (some.parts.size() != others.parts.size() || some.ended != others.ended ||
      some.complete != others.complete) {
    std::abort();
  }
  for (size_t i = 0; i < some.ended; ++i) {
    if (some.parts[i] != others.parts[i]) {
      std::abort();
    }
  }
}

}  // namespace clipgs::fuzz
