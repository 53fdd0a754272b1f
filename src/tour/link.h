#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tour/mark.h"
#include "tour/shown.h"

#include "splat/scene.h"

namespace clipgs {

/// The words of the viewer's address (docs/viewer.md), in their order:
/// "view=30,20&plane=0,0,-1,40". What is not valid among them is left out, as the viewer does. The
/// twin of web/src/model/link.ts.
class Link {
 public:
  explicit Link(std::string_view words);

  /// Name of the case; "": none is named.
  std::string case_name() const { return get("case"); }
  /// What is shown where `before` was, of a case with these states, along that axis.
  Shown shown(const Shown& before, const PlaneStates& states, const Vec3& axis) const;
  /// What is marked, in its order; `name` is of the mark before it.
  std::vector<Mark> marks() const;

 private:
  struct Word {
    std::string key;
    std::string value;
  };

  /// The first of that key, or "".
  std::string get(std::string_view key) const;
  std::vector<double> numbers(std::string_view key, size_t least, size_t most) const;
  bool hides(std::string_view what) const;
  void take_view(Shown& shown) const;
  void take_cuts(Shown& shown, const PlaneStates& states, const Vec3& axis) const;
  void take_light(Shown& shown) const;

  std::vector<Word> words_;
};

}  // namespace clipgs
