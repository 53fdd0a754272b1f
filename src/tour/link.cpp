#include "tour/link.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/background.h"
#include "volume/preset.h"

namespace clipgs {

namespace {

using glm::dvec3;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t end = text.find(separator); end != std::string_view::npos;
       end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

/// As browsers read what follows an address's #.
std::string decoded(std::string_view text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    int byte = 0;
    const char* const hex = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(hex, hex + 2, byte, 16).ptr == hex + 2) {
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += text[i] == '+' ? ' ' : text[i];
    }
  }
  return result;
}

/// Finite numbers with commas between; none where there are others than that many.
std::vector<double> parsed(std::string_view text, size_t least, size_t most) {
  std::vector<double> values;
  for (std::string_view part : split(text, ',')) {
    part.remove_prefix(std::min(part.find_first_not_of(' '), part.size()));
    double value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    const auto rest = part.substr(static_cast<size_t>(end - part.data()));
    if (error != std::errc() || rest.find_first_not_of(' ') != std::string_view::npos ||
        !std::isfinite(value)) {
      return {};
    }
    values.push_back(value);
  }
  return values.size() >= least && values.size() <= most ? values : std::vector<double>();
}

template <size_t N>
bool is_one_of(const std::string& text, const std::array<const char*, N>& known) {
  return std::ranges::find(known, text) != known.end();
}

/// `nx,ny,nz,c` of a plane or `nx,ny,nz,c,thickness` of a slab.
std::optional<ShownCut> parse_cut(const std::string& text, bool is_slab) {
  const std::vector<double> n = parsed(text, is_slab ? 5 : 4, is_slab ? 5 : 4);
  const double length = n.empty() ? 0 : glm::length(dvec3(n[0], n[1], n[2]));
  if (length == 0 || (is_slab && n[4] <= 0)) {
    return std::nullopt;
  }
  return ShownCut{dvec3(n[0], n[1], n[2]) / length, n[3] / length,
                  is_slab ? std::optional(n[4]) : std::nullopt};
}

size_t planes_of(const std::vector<ShownCut>& cuts) {
  return cuts.size() + static_cast<size_t>(std::ranges::count_if(
                           cuts, [](const ShownCut& cut) { return cut.thickness.has_value(); }));
}

/// Of a case that is asked for by a number of up to five digits.
std::optional<int> parse_state(const std::string& text) {
  const bool is_number = !text.empty() && text.size() <= 5 &&
                         text.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? std::optional(std::stoi(text)) : std::nullopt;
}

/// Whether a rig of that name can light cases: its lamps are infinitely far away.
bool lights_cases(const std::string& rig) {
  const std::vector<std::string> names = rig_names();
  return std::ranges::find(names, rig) != names.end() &&
         std::ranges::all_of(load_rig(rig).keys,
                             [](const KeyLight& key) { return key.distance <= 0; });
}

std::optional<MarkKind> mark_kind(const std::string& key) {
  constexpr std::array kKeys = {"pin", "length", "angle", "region", "outline"};
  const auto* const found = std::ranges::find(kKeys, key);
  return found == kKeys.end() ? std::nullopt
                              : std::optional(static_cast<MarkKind>(found - kKeys.begin()));
}

/// `to`, as links had it once, measures from the point before it.
void join(std::vector<Mark>& marks, const std::string& text) {
  std::vector<double> numbers = parsed(text, 3, 3);
  const bool joins = !numbers.empty() && !marks.empty() && !marks.back().is_flat() &&
                     marks.back().kind != MarkKind::kAngle;
  if (joins) {
    const dvec3 from = marks.back().points.back();
    numbers.insert(numbers.begin(), {from.x, from.y, from.z});
    if (marks.back().kind == MarkKind::kPoint) {
      marks.pop_back();
    }
  }
  if (auto mark = make_mark(joins ? MarkKind::kLength : MarkKind::kPoint, numbers)) {
    marks.push_back(std::move(*mark));
  }
}

}  // namespace

Link::Link(std::string_view words) {
  if (words.starts_with('#')) {
    words.remove_prefix(1);
  }
  for (const std::string_view word : split(words, '&')) {
    const size_t end = std::min(word.find('='), word.size());
    words_.push_back(
        {decoded(word.substr(0, end)), decoded(word.substr(std::min(end + 1, word.size())))});
  }
}

std::string Link::get(std::string_view key) const {
  const auto found = std::ranges::find(words_, key, &Word::key);
  return found == words_.end() ? "" : found->value;
}

std::vector<double> Link::numbers(std::string_view key, size_t least, size_t most) const {
  return parsed(get(key), least, most);
}

bool Link::hides(std::string_view what) const {
  const std::string hidden = get("hide");
  const std::vector<std::string_view> all = split(hidden, ',');
  return std::ranges::find(all, what) != all.end();
}

void Link::take_view(Shown& shown) const {
  const std::vector<double> view = numbers("view", 2, 3);
  const double zoom = view.size() == 3 ? view[2] : 1;
  if (view.empty() || zoom <= 0) {
    return;
  }
  shown.view = {view[0], view[1], zoom};
  if (const std::vector<double> pan = numbers("pan", 3, 3); !pan.empty()) {
    shown.view.pan = {pan[0], pan[1], pan[2]};
  }
  if (const std::vector<double> back = numbers("back", 1, 1); !back.empty()) {
    shown.view.back = back[0];
  }
}

void Link::take_cuts(Shown& shown, const PlaneStates& states, const Vec3& axis) const {
  const std::string state = get("state");
  if (state == "off") {
    shown.cuts.clear();
    return;
  }
  if (const std::optional<int> k = parse_state(state)) {
    const double sign = states.keeps_below ? -1 : 1;
    const double place = states.first + static_cast<double>(std::min(*k, states.count - 1)) *
                                            static_cast<double>(states.spacing);
    shown.cuts = {ShownCut{sign * dvec3(axis), sign * place, std::nullopt}};
    return;
  }
  std::vector<ShownCut> cuts;
  for (const Word& word : words_) {
    if (word.key == "plane" || word.key == "slab") {
      if (const std::optional<ShownCut> cut = parse_cut(word.value, word.key == "slab")) {
        cuts.push_back(*cut);
      }
    }
  }
  if (!cuts.empty() && planes_of(cuts) <= Cut::kMostPlanes) {
    shown.cuts = cuts;
  } else if (get("plane") == "off") {
    shown.cuts.clear();
  }
}

void Link::take_light(Shown& shown) const {
  shown.rig.reset();
  if (const std::string rig = get("rig"); lights_cases(rig)) {
    shown.rig = rig;
  }
  const std::vector<double> turn = numbers("turn", 1, 1);
  shown.turn = turn.empty() ? 0 : std::fmod(turn[0], 360.0);
  const std::vector<double> lamp = numbers("lamp", 3, 3);
  const dvec3 from = lamp.empty() ? dvec3(0) : dvec3(lamp[0], lamp[1], lamp[2]);
  shown.lamp = glm::length(from) > 0 ? std::optional(glm::normalize(from)) : std::optional<dvec3>();
}

Shown Link::shown(const Shown& before, const PlaneStates& states, const Vec3& axis) const {
  Shown result = before;
  take_view(result);
  take_cuts(result, states, axis);
  take_light(result);
  if (const std::string clip = get("clip");
      is_one_of<4>(clip, {"hard", "soft", "exact", "layers"})) {
    result.clip = clip;
  }
  result.section = get("section") == "splats" ? "splats" : "volume";
  const std::vector<double> grey = numbers("grey", 1, 1);
  result.grey = !grey.empty() && grey[0] >= 0 && grey[0] <= 1 ? grey[0] : 0;
  const std::string openings = get("openings");
  result.openings = is_one_of<2>(openings, {"neutral", "values"}) ? openings : "cinematic";
  if (const std::vector<double> window = numbers("window", 2, 2);
      !window.empty() && window[1] > 0) {
    result.window = {window[0], window[1]};
  }
  const std::string background = get("background");
  result.background =
      find_background(background) ? std::optional(background) : std::optional<std::string>();
  const std::vector<double> cue = numbers("depth-cue", 1, 1);
  result.depth_cue = !cue.empty() && cue[0] > 0 && cue[0] <= 1 ? cue[0] : 0;
  result.body = !hides("body");
  result.faces = !hides("faces");
  result.marks = !hides("marks");
  result.handle = !hides("handle");
  return result;
}

std::vector<Mark> Link::marks() const {
  std::vector<Mark> marks;
  for (const Word& word : words_) {
    if (word.key == "to") {
      join(marks, word.value);
    } else if (const std::optional<MarkKind> kind = mark_kind(word.key)) {
      if (auto mark = make_mark(*kind, parsed(word.value, 3, 3 * (kMostCorners + 1)))) {
        marks.push_back(std::move(*mark));
      }
    } else if (word.key == "name" && !marks.empty()) {
      marks.back().name = word.value;
    }
  }
  marks.resize(std::min(marks.size(), kMostMarks));
  return marks;
}

}  // namespace clipgs
