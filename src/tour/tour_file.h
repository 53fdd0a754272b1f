#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clipgs {

/// A view that was saved, with what is said of it.
struct Stop {
  std::string name;
  std::string text;
  std::string show;  ///< what is shown, in the words of the viewer's address (Link)
  double fly = 3;    ///< s, of the flight there …
  double stay = 5;   ///< … and of the stay
};

/// Stops that a viewer flies between.
struct Tour {
  std::string volume;  ///< whose tour it is; "": that is not known
  std::vector<Stop> stops;
};

/// Reads a tour (docs/format.md), of one stop at least. Throws Error where the file is none, or of
/// a newer version. The twin of parseTour() in web/src/model/tour.ts.
Tour read_tour(const std::filesystem::path& path);

}  // namespace clipgs
