#include "serve/qr.h"

#include <memory>
#include <qrencode.h>

#include "core/error.h"

namespace clipgs {

namespace {

constexpr int kQuietZone = 2;  // modules; four are asked for, two are enough on a screen
constexpr const char* kBlackOnWhite = "\x1b[30;107m";
constexpr const char* kReset = "\x1b[0m";

struct Free {
  void operator()(QRcode* code) const { QRcode_free(code); }
};

}  // namespace

std::string qr_code(const std::string& text) {
  const std::unique_ptr<QRcode, Free> code(
      QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_L, QR_MODE_8, 1));
  if (!code) {
    throw Error("an address of {} characters is too long for a QR code", text.size());
  }
  const int width = code->width;
  const auto dark = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < width && (code->data[y * width + x] & 1) != 0;
  };
  std::string result;
  for (int y = -kQuietZone; y < width + kQuietZone; y += 2) {
    result += kBlackOnWhite;
    for (int x = -kQuietZone; x < width + kQuietZone; ++x) {
      const bool upper = dark(x, y);
      const bool lower = dark(x, y + 1);
      result += upper ? (lower ? "█" : "▀") : (lower ? "▄" : " ");
    }
    result += kReset;
    result += '\n';
  }
  return result;
}

}  // namespace clipgs
