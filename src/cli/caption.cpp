#include "cli/caption.h"

#include <algorithm>
#include <vector>

#include "cli/text_box.h"
#include "core/draw_text.h"

namespace clipgs {

namespace {

constexpr double kRoom = 0.55;  // of the width, beside the warning
constexpr size_t kMostLines = 12;
constexpr const char* kWarning = "Not for diagnosis";

/// Lines that are no wider than `room`, but for words that are.
std::vector<std::string> lines_of(cairo_t* cairo, const std::string& text, double size,
                                  double room) {
  std::vector<std::string> lines(1);
  std::string word;
  const auto end_word = [&] {
    std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || width_of(cairo, longer, size, false) <= room) {
      lines.back() = std::move(longer);
    } else {
      lines.push_back(word);
    }
    word.clear();
  };
  for (const char c : text) {
    if (c == '\n') {
      end_word();
      lines.emplace_back();
    } else if (c == ' ') {
      end_word();
    } else {
      word += c;
    }
  }
  end_word();
  std::erase(lines, "");
  return lines;
}

}  // namespace

void draw_caption(Image& picture, const std::string& name, const std::string& text) {
  const Overlay overlay(picture.width, picture.height);
  cairo_t* const cairo = overlay.cairo();
  const double size = std::max(9.0, 0.026 * std::min(picture.width, picture.height));
  const double room = kRoom * picture.width;
  std::vector<std::string> lines;
  if (!name.empty()) {
    lines.push_back(name);
  }
  for (std::string& line : lines_of(cairo, text, size, room)) {
    lines.push_back(std::move(line));
  }
  if (lines.size() > kMostLines) {
    lines.resize(kMostLines);
    lines.back() += " …";
  }
  if (!lines.empty()) {
    TextBox(cairo, lines, size, !name.empty()).draw(size, size);
  }
  const TextBox warning(cairo, {kWarning}, 0.9 * size, false);
  warning.draw(picture.width - size - warning.width(), size);
  overlay.put_over(picture);
}

}  // namespace clipgs
