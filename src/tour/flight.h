#pragma once

#include "tour/shown.h"

#include "core/geometry.h"

namespace clipgs {

/// What is shown after a share of the way from one view to another, of a body in that sphere. The
/// twin of web/src/model/flight.ts, where it is said why; flights.json holds both to the same
/// numbers.
Shown flight(const Shown& from, const Shown& to, double share, const Sphere& sphere);

}  // namespace clipgs
