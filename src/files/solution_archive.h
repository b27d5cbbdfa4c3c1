// A solution as named runs of bytes, and back. The order of the bytes is in docs/solution_file.md.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "files/solution_file.h"

namespace goldthread {

/// The sections of a solution, in the order they are stored.
std::vector<std::string> section_names();
/// Whether a section is stored only where there is something in it, so that solutions without are the same
/// bytes as ever.
bool is_optional_section(const std::string& name);
/// Empty for an optional section that there is no need for.
std::vector<uint8_t> pack_section(const Solution& solution, const std::string& name);

/// Fills the part of `solution` that `bytes` hold. False when they end early, go on too long, or state a
/// count that they cannot hold; nothing larger than the bytes themselves is allocated.
bool unpack_section(Solution& solution, const std::string& name, const std::vector<uint8_t>& bytes);

/// What does not fit together: an index out of range, arrays of different lengths. Empty when all is well.
std::string find_contradiction(const Solution& solution);

}  // namespace goldthread
