#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// Reads the values of one JSON object, with errors that say which key of which file is wrong.
/// Every function throws Error if the key is missing or its value is not of the kind asked for.
class JsonReader {
 public:
  /// `object` must outlive the reader; `name` is what errors call it, and `remedy` what they tell
  /// people to do, e.g. "make the dataset again".
  JsonReader(const nlohmann::json& object, std::string name, std::string remedy = "");

  /// Whether the object has the key, with a value other than null.
  bool has(const char* key) const;
  JsonReader child(const char* key) const { return {at(key), name_ + "." + key, remedy_}; }
  /// The elements of a list of objects, at most `most` of them.
  std::vector<JsonReader> children(const char* key, size_t most) const;

  float number(const char* key) const { return finite(at(key), key); }
  float positive(const char* key) const;
  /// A whole number in [low, high].
  int integer(const char* key, int low, int high) const;
  /// Exactly `count` finite numbers.
  std::vector<float> numbers(const char* key, size_t count) const;
  bool boolean(const char* key) const;
  static constexpr size_t kMostText = 256;                           ///< bytes
  std::string text(const char* key, size_t most = kMostText) const;  ///< `most`: bytes

  template <int N>
  glm::vec<N, float> vector(const char* key) const {
    const std::vector<float> values = numbers(key, N);
    glm::vec<N, float> result;
    for (int i = 0; i < N; ++i) {
      result[i] = values[static_cast<size_t>(i)];
    }
    return result;
  }
  Vec3 unit_vector(const char* key) const;
  /// Four rows of four numbers.
  glm::dmat4 matrix(const char* key) const;

  /// Throws Error if there is a key that is none of these: a misspelt one would be passed over.
  void allow_only(std::initializer_list<std::string_view> keys) const;

  [[noreturn]] void fail(const char* key) const;
  /// As fail(), for a value that is there and should be `expected`, e.g. "a unit vector".
  [[noreturn]] void fail(const char* key, const char* expected) const;

 private:
  const nlohmann::json& at(const char* key) const;
  float finite(const nlohmann::json& value, const char* key) const;

  std::string remedy() const { return remedy_.empty() ? "" : "; " + remedy_; }

  const nlohmann::json& object_;
  std::string name_;
  std::string remedy_;
};

/// −0 as 0, which is how numbers are written, here and for people.
inline float plain_zero(float x) { return x + 0.0f; }

/// The shortest decimal that reads back as the same float, as a JSON number; 0 for −0.
nlohmann::json json_number(float value);
nlohmann::json json_vector(const Vec3& v);  ///< three of them

}  // namespace clipgs
