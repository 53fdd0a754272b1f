#pragma once

#include <array>

namespace clipgs {

/// Values that are shown from black to white, value units (HU for CT).
struct Window {
  float center = 40;
  float width = 400;
};

/// A window as radiologists call it.
struct NamedWindow {
  const char* name;
  Window window;
};

/// The windows that a CT is usually seen through, HU; the viewer has the same. The first is where
/// it begins.
inline constexpr std::array kCtWindows = {
    NamedWindow{"soft-tissue", {40, 400}}, NamedWindow{"bone", {400, 1800}},
    NamedWindow{"lung", {-600, 1500}}, NamedWindow{"brain", {40, 80}}};

}  // namespace clipgs
