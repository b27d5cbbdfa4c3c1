// KHR_draco_mesh_compression: from Draco's bitstream to plain accessors.
#pragma once
#include <optional>
#include <string>

#include "files/gltf_load.h"
#include "files/gltf_read_container.h"
#include "goldthread/error.h"

namespace goldthread {

/// The buffer that decoded data goes to while it is not yet part of the model, and how large it may become.
struct ExpandedBuffer {
  explicit ExpandedBuffer(const tinygltf::Model& model);

  /// Offset of `bytes` new bytes, aligned to 4; nothing when that is more than such a file may need.
  std::optional<size_t> append(size_t bytes);
  Error too_much(const std::string& file, const std::string& place) const;

  Bytes data;
  bool used = false;  ///< something refers to the buffer, even if it has no bytes
  size_t limit = 0;
};

/// Turns every Draco primitive into a triangle list with plain accessors. Accessors are overwritten in place,
/// or appended where one is shared by primitives of different bitstreams.
Status expand_draco(tinygltf::Model& model, const std::string& file, ExpandedBuffer& expanded);

}  // namespace goldthread
