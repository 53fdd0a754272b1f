#include "study/grim.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <string_view>

#include "core/error.h"

namespace clipgs {

namespace {

constexpr size_t kMostScores = 100000;
constexpr int kMostMeanDigits = 9;
constexpr int kMostMeanPlaces = 6;
constexpr int kMostStepPlaces = 3;
constexpr std::int64_t kMostStep = 1000;

/// units / 10^places.
struct Decimal {
  std::int64_t units = 0;
  int places = 0;
};

std::int64_t power_of_ten(int exponent) {
  std::int64_t value = 1;
  for (; exponent > 0; --exponent) {
    value *= 10;
  }
  return value;
}

std::optional<Decimal> parse_decimal(std::string_view text, int most_places) {
  Decimal result;
  bool point = false;
  int digits = 0;
  for (const char c : text) {
    if (c == '.' && !point) {
      point = true;
    } else if (c >= '0' && c <= '9') {
      result.units = result.units * 10 + (c - '0');
      result.places += point ? 1 : 0;
      ++digits;
    } else {
      return std::nullopt;
    }
    if (digits > kMostMeanDigits || result.places > most_places) {
      return std::nullopt;
    }
  }
  return digits > 0 ? std::optional(result) : std::nullopt;
}

std::string decimal_text(const Decimal& value) {
  const std::int64_t one = power_of_ten(value.places);
  return value.places == 0
             ? fmt::format("{}", value.units)
             : fmt::format("{}.{:0{}}", value.units / one, value.units % one, value.places);
}

/// Without zeros at its end.
std::string short_text(Decimal value) {
  while (value.places > 0 && value.units % 10 == 0) {
    value.units /= 10;
    --value.places;
  }
  return decimal_text(value);
}

/// A check in whole numbers: the mean of k steps is k·step / scale in units of the mean's last
/// digit, times `scale` here.
struct WholeCheck {
  Decimal mean;
  Decimal step;
  std::int64_t per_step;  // what one step adds to the scaled mean
  std::int64_t scale;
};

WholeCheck whole_check(const GrimCheck& check) {
  const std::optional<Decimal> mean = parse_decimal(check.mean, kMostMeanPlaces);
  if (!mean) {
    throw Error(
        "\"{}\" is no mean like 71.80 (up to {} digits, {} after the point); give it as "
        "it is printed",
        check.mean, kMostMeanDigits, kMostMeanPlaces);
  }
  const std::optional<Decimal> step = parse_decimal(check.step, kMostStepPlaces);
  if (!step || step->units == 0 || step->units > kMostStep * power_of_ten(step->places)) {
    throw Error("\"{}\" is no step of a score; give 0.001 to {}, e.g. 2.5 for SUS", check.step,
                kMostStep);
  }
  if (check.n < 1 || check.n > kMostScores) {
    throw Error("a mean of {} scores cannot be checked; give 1 to {}", check.n, kMostScores);
  }
  return {*mean, *step, step->units * power_of_ten(mean->places),
          static_cast<std::int64_t>(check.n) * power_of_ten(step->places)};
}

/// Whether `steps` give the printed mean, rounded half up or half to even.
bool rounds_to_mean(const WholeCheck& check, std::int64_t steps) {
  const std::int64_t twice_off = 2 * (steps * check.per_step - check.mean.units * check.scale);
  const bool half_to_even = check.mean.units % 2 == 0;
  return twice_off >= -check.scale &&
         (twice_off < check.scale || (twice_off == check.scale && half_to_even));
}

GrimSum sum_of(const WholeCheck& check, std::int64_t steps) {
  const std::int64_t rounded = (2 * steps * check.per_step + check.scale) / (2 * check.scale);
  return {short_text({steps * check.step.units, check.step.places}),
          decimal_text({rounded, check.mean.places})};
}

}  // namespace

GrimCheck parse_grim_check(const std::string& text) {
  const size_t first = text.find(',');
  const size_t last = text.rfind(',');
  const std::string_view count =
      first == std::string::npos
          ? std::string_view()
          : std::string_view(text).substr(first + 1, std::max(last, first + 1) - first - 1);
  GrimCheck check;
  const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), check.n);
  if (error != std::errc() || end != count.data() + count.size()) {
    throw Error("\"{}\" is no check; give MEAN,N,STEP, e.g. 71.80,10,2.5", text);
  }
  check.mean = text.substr(0, first);
  check.step = text.substr(last + 1);
  whole_check(check);
  return check;
}

GrimResult grim(const GrimCheck& check) {
  const WholeCheck whole = whole_check(check);
  const std::int64_t steps = whole.mean.units * whole.scale / whole.per_step;
  return {rounds_to_mean(whole, steps) || rounds_to_mean(whole, steps + 1), sum_of(whole, steps),
          sum_of(whole, steps + 1)};
}

std::string grim_text(const GrimCheck& check) {
  const GrimResult result = grim(check);
  return fmt::format(
      "{} {} come from {} scores that are multiples of {}; the nearest sums: {} (mean {}) and {} "
      "(mean {})",
      check.mean, result.possible ? "can" : "cannot", check.n, check.step, result.below.sum,
      result.below.mean, result.above.sum, result.above.mean);
}

}  // namespace clipgs
