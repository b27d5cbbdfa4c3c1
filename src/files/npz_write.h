// NumPy's .npz: a zip of arrays.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "goldthread/error.h"

namespace goldthread {

/// One array of an .npz file; `name` without ".npy". Borrowed: must outlive the call.
struct NpzArray {
  std::string name;
  std::variant<std::span<const double>, std::span<const int64_t>, std::span<const float>, std::string> values;
};

/// Writes the arrays as one file, whole or not at all. A string becomes an array of no dimension, of bytes,
/// as scipy.sparse.load_npz wants its "format".
Status write_npz(const std::string& file, std::span<const NpzArray> arrays);

}  // namespace goldthread
