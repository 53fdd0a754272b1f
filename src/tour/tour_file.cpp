#include "tour/tour_file.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"

namespace clipgs {

namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{16} << 20;
constexpr size_t kMostStops = 100;
constexpr size_t kLongestText = size_t{16} << 10;  // bytes
constexpr size_t kLongestShow = size_t{160} << 10;
constexpr double kLongestFlight = 60;  // s
constexpr double kLongestStay = 600;

double seconds(const JsonReader& reader, const char* key, double otherwise, double most) {
  const double value = reader.has(key) ? static_cast<double>(reader.number(key)) : otherwise;
  if (value < 0 || value > most) {
    reader.fail(key);
  }
  return value;
}

Stop read_stop(const JsonReader& reader) {
  const auto text = [&](const char* key) {
    return reader.has(key) ? reader.text(key, kLongestText) : std::string();
  };
  const Stop usual;
  return {text("name"), text("text"), reader.text("show", kLongestShow),
          seconds(reader, "fly", usual.fly, kLongestFlight),
          seconds(reader, "stay", usual.stay, kLongestStay)};
}

}  // namespace

Tour read_tour(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path, kMostBytes);
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  const std::string name = path.filename().string();
  if (!json.is_object() || !json.contains("clipgs_tour")) {
    throw Error("{}: not a tour; the viewer saves one", name);
  }
  if (json["clipgs_tour"] != 1) {
    throw Error("{}: of a version that this program does not know; use a newer clipgs", name);
  }
  const JsonReader reader(json, name, "save the tour again");
  Tour tour;
  tour.volume = reader.has("volume") ? reader.text("volume") : "";
  for (const JsonReader& stop : reader.children("stops", kMostStops)) {
    tour.stops.push_back(read_stop(stop));
  }
  if (tour.stops.empty()) {
    throw Error("{}: has no stops; save views in the viewer first", name);
  }
  return tour;
}

}  // namespace clipgs
