// Stands before src/core/parallel.h where C++ is compiled for the browser: a worker is one thread.
#pragma once

#include <algorithm>
#include <cstddef>

namespace clipgs {

template <typename Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  for (std::size_t begin = 0; begin < count; begin += grain) {
    body(begin, std::min(begin + grain, count));
  }
}

}  // namespace clipgs
