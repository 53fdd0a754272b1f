#include "tour/flight.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tour/link.h"

#include "core/file.h"

namespace clipgs {
namespace {

using nlohmann::json;

constexpr double kNear = 1e-6;

json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

template <typename T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json(nullptr);
}

/// As flights.json and web/test/unit/tour_fixture.ts have it.
json json_of(const Shown& shown) {
  json cuts = json::array();
  for (const ShownCut& cut : shown.cuts) {
    cuts.push_back({{"normal", vector_json(cut.normal)},
                    {"offset", cut.offset},
                    {"thickness", or_null(cut.thickness)}});
  }
  const ShownView& view = shown.view;
  json window = nullptr;
  if (shown.window) {
    window = {shown.window->center, shown.window->width};
  }
  return {{"view", {view.azimuth, view.elevation, view.zoom, view.back}},
          {"pan", vector_json(view.pan)},
          {"cuts", cuts},
          {"window", window},
          {"grey", shown.grey},
          {"turn", shown.turn},
          {"lamp", shown.lamp ? vector_json(*shown.lamp) : json(nullptr)},
          {"depth_cue", shown.depth_cue},
          {"clip", shown.clip},
          {"section", shown.section},
          {"openings", shown.openings},
          {"rig", or_null(shown.rig)},
          {"background", or_null(shown.background)},
          {"body", shown.body},
          {"faces", shown.faces},
          {"marks", shown.marks},
          {"handle", shown.handle}};
}

void expect_near(const json& actual, const json& expected, const std::string& path) {
  if (expected.is_number()) {
    EXPECT_NEAR(actual.get<double>(), expected.get<double>(), kNear) << path;
  } else if (expected.is_structured()) {
    ASSERT_EQ(actual.size(), expected.size()) << path;
    for (const auto& [key, value] : expected.items()) {
      expect_near(expected.is_array() ? actual[std::stoul(key)] : actual[key], value,
                  path + "." + key);
    }
  } else {
    EXPECT_EQ(actual, expected) << path;
  }
}

TEST(Flight, ShowsWhatTheViewerDoes) {
  const json fixture = json::parse(read_text(CLIPGS_SOURCE_DIR "/src/tour/flights.json"));
  const auto center = fixture["sphere"]["center"].get<std::vector<float>>();
  const Sphere sphere{{center[0], center[1], center[2]}, fixture["sphere"]["radius"]};
  const json& said = fixture["states"];
  const auto axis = said["axis"].get<std::vector<float>>();
  const PlaneStates states{said["count"], said["first"], said["spacing"], said["keeps"] == "below"};
  ASSERT_GT(fixture["flights"].size(), 20U);
  for (const json& one : fixture["flights"]) {
    const auto shown = [&](const char* key) {
      return Link(one[key].get<std::string>())
          .shown(Shown(), states, Vec3(axis[0], axis[1], axis[2]));
    };
    expect_near(json_of(flight(shown("from"), shown("to"), one["share"], sphere)), one["shown"],
                one["to"].get<std::string>() + " at " + one["share"].dump());
  }
}

TEST(Crossing, IsTheViewers) {
  const json fixture = json::parse(read_text(CLIPGS_SOURCE_DIR "/src/tour/flights.json"));
  ASSERT_GT(fixture["crossings"].size(), 5U);
  for (const json& one : fixture["crossings"]) {
    const Crossing way = crossing(one["share"]);
    EXPECT_NEAR(way.before, one["before"].get<double>(), kNear);
    EXPECT_NEAR(way.flown, one["flown"].get<double>(), kNear);
  }
}

TEST(Flight, EndsWhereItIsToEnd) {
  const Shown from = Link("view=170,10").shown(Shown(), {}, Vec3(0, 0, 1));
  const Shown to = Link("view=-150,60,8&plane=0,0,-1,-40").shown(Shown(), {}, Vec3(0, 0, 1));
  const Sphere sphere{{10, -20, 30}, 100};
  expect_near(json_of(flight(from, to, 0, sphere)), json_of(from), "from");
  expect_near(json_of(flight(from, to, 1, sphere)), json_of(to), "to");
}

TEST(Link, LeavesOutWhatIsNotValid) {
  const Shown before;
  const Link link(
      "view=30,20,0&plane=0,0,0,1&slab=1,0,0,2,-3&grey=2&window=40,0&rig=moon&lamp=0,0,0&clip=x&"
      "state=-1&background=pink&depth-cue=nan&pin=1,2&pin=1,2,3,4");
  expect_near(json_of(link.shown(before, {}, Vec3(0, 0, 1))), json_of(before), "nothing");
  EXPECT_TRUE(link.marks().empty());
  const Link said("#case=Sch%C3%A4del+2&pin=1,-2.5,3&plane=off&view=1");
  EXPECT_EQ(said.case_name(), "Schädel 2");
  ASSERT_EQ(said.marks().size(), 1U);
  EXPECT_EQ(said.marks()[0].points[0], glm::dvec3(1, -2.5, 3));
}

TEST(ShownView, IsTheCameraOfTheRendererAndStaysWhereItIsInAnotherSphere) {
  const Sphere sphere{{10, -20, 30}, 100};
  const Camera framed = frame_sphere(sphere, View{30, 20, 2}, 320, 200);
  const ShownView view{30, 20, 2};
  const Camera camera = camera_of(view, sphere, 320, 200);
  EXPECT_LT(glm::length(camera.position - framed.position), 1e-3f);
  EXPECT_FLOAT_EQ(camera.fx, framed.fx);
  const Sphere other{{-4, 8, 2}, 70};
  const Camera same = camera_of(reframed(view, sphere, other), other, 320, 200);
  EXPECT_LT(glm::length(camera.position - same.position), 1e-2f);
  EXPECT_FLOAT_EQ(camera.fx, same.fx);
}

}  // namespace
}  // namespace clipgs
