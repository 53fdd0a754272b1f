#pragma once

#include "tour/shown.h"

#include "core/geometry.h"

namespace clipgs {

/// What is shown after a share of the way from one view to another, of a body in that sphere. The
/// twin of web/src/model/flight.ts, where it is said why; flights.json holds both to the same
/// numbers.
Shown flight(const Shown& from, const Shown& to, double share, const Sphere& sphere);

/// On the way to another look, which comes before anything moves.
struct Crossing {
  double before;  ///< of the picture, what the look before still is
  double flown;   ///< of the flight, what is behind
};
Crossing crossing(double share);

}  // namespace clipgs
