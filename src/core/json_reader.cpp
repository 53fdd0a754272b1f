#include "core/json_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

#include "core/error.h"

namespace clipgs {

using nlohmann::json;

JsonReader::JsonReader(const json& object, std::string name, std::string remedy)
    : object_(object), name_(std::move(name)), remedy_(std::move(remedy)) {
  if (!object_.is_object()) {
    throw Error("{}: a JSON object was expected; {}", name_,
                remedy_.empty() ? "the file is corrupt" : remedy_);
  }
}

bool JsonReader::has(const char* key) const {
  const auto found = object_.find(key);
  return found != object_.end() && !found->is_null();
}

std::vector<JsonReader> JsonReader::children(const char* key, size_t most) const {
  const json& list = at(key);
  if (!list.is_array() || list.size() > most) {
    fail(key);
  }
  std::vector<JsonReader> result;
  result.reserve(list.size());
  for (size_t i = 0; i < list.size(); ++i) {
    result.emplace_back(list[i], fmt::format("{}.{}[{}]", name_, key, i), remedy_);
  }
  return result;
}

float JsonReader::positive(const char* key) const {
  const float value = number(key);
  if (value <= 0) {
    fail(key, "a positive number");
  }
  return value;
}

int JsonReader::integer(const char* key, int low, int high) const {
  const json& value = at(key);
  if (!value.is_number_integer() || value.get<std::int64_t>() < low ||
      value.get<std::int64_t>() > high) {
    fail(key);
  }
  return value.get<int>();
}

std::vector<float> JsonReader::numbers(const char* key, size_t count) const {
  const json& values = at(key);
  if (!values.is_array() || values.size() != count) {
    fail(key);
  }
  std::vector<float> result;
  result.reserve(count);
  for (const json& value : values) {
    result.push_back(finite(value, key));
  }
  return result;
}

bool JsonReader::boolean(const char* key) const {
  const json& value = at(key);
  if (!value.is_boolean()) {
    fail(key);
  }
  return value.get<bool>();
}

std::string JsonReader::text(const char* key, size_t most) const {
  const json& value = at(key);
  if (!value.is_string() || value.get_ref<const std::string&>().size() > most) {
    fail(key);
  }
  return value.get<std::string>();
}

Vec3 JsonReader::unit_vector(const char* key) const {
  constexpr float kTolerance = 1e-3f;  // of the length
  const Vec3 value = vector<3>(key);
  if (!(std::abs(glm::length(value) - 1) < kTolerance)) {
    fail(key, "a unit vector");
  }
  return value;
}

glm::dmat4 JsonReader::matrix(const char* key) const {
  const json& rows = at(key);
  if (!rows.is_array() || rows.size() != 4) {
    fail(key);
  }
  glm::dmat4 result;
  for (int r = 0; r < 4; ++r) {
    if (!rows[r].is_array() || rows[r].size() != 4) {
      fail(key);
    }
    for (int c = 0; c < 4; ++c) {
      if (!rows[r][c].is_number()) {
        fail(key);
      }
      result[c][r] = rows[r][c].get<double>();
    }
  }
  return result;
}

void JsonReader::allow_only(std::initializer_list<std::string_view> keys) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::ranges::find(keys, key) == keys.end()) {
      throw Error("{}: \"{}\" is no key there{}", name_, key, remedy());
    }
  }
}

void JsonReader::fail(const char* key) const {
  throw Error("{}: \"{}\" is missing or out of range{}", name_, key, remedy());
}

void JsonReader::fail(const char* key, const char* expected) const {
  throw Error("{}: \"{}\" is not {}{}", name_, key, expected, remedy());
}

const json& JsonReader::at(const char* key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) {
    fail(key);
  }
  return *found;
}

float JsonReader::finite(const json& value, const char* key) const {
  if (!value.is_number() || !std::isfinite(value.get<float>())) {
    fail(key);
  }
  return value.get<float>();
}

json json_number(float value) {
  return std::strtod(fmt::format("{}", plain_zero(value)).c_str(), nullptr);
}

json json_vector(const Vec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

}  // namespace clipgs
