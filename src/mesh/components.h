// Connected components: triangles that reach each other across twins.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace goldthread {

struct Components {
  std::vector<uint32_t> of_triangle;  ///< component number of each triangle
  uint32_t count = 0;                 ///< numbered in order of their first triangle
};

/// `twins` as find_twins() returns them. The same for any number of threads.
Components find_components(std::span<const uint32_t> twins);

}  // namespace goldthread
