// The lamps that hang in a glTF file's nodes.
#pragma once
#include <string>

#include "files/gltf_read_nodes.h"

namespace goldthread {

/// Appends the lights of all shown nodes, in the order of the nodes: those of KHR_lights_punctual, and the
/// light profiles of EXT_lights_ies as point lights. A node that has both is one lamp, which shines as its
/// profile says: exporters write the other for those who cannot read it. Error: a light or profile that is
/// not there or cannot be read.
Status read_gltf_lights(const tinygltf::Model& model, const std::string& file, const NodePlacements& nodes,
                        Scene& scene);

}  // namespace goldthread
