// Whether a PLY file holds all that its header promises.
#pragma once
#include <string>
#include <string_view>

#include "goldthread/error.h"

namespace goldthread {

/// An Error (kBadInput) that names the first element missing from a file that was cut off, or the line of the
/// header that makes no sense. assimp does not look: it waits for ever for the end of a header, takes the
/// last line again and again, or what lies in memory after the end.
Status check_ply_length(std::string_view bytes, const std::string& file);

}  // namespace goldthread
