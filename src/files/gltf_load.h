// A glTF or GLB file as tinygltf's model: the common first step of the reader and the writer.
#pragma once
#include <string>

#include "goldthread/error.h"

#ifdef __clang__
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wdouble-promotion"
#endif
#include <tiny_gltf.h>
#ifdef __clang__
#pragma clang diagnostic pop
#endif

namespace goldthread {

/// Parses `file` and fetches its buffers and pictures. What tinygltf's own loader would not do:
/// - Compression is undone. Buffer views under EXT_meshopt_compression and primitives under
///   KHR_draco_mesh_compression come out as plain buffer views and accessors (of one buffer appended to the
///   file's own), without the extension, and neither name remains in extensionsUsed or extensionsRequired.
///   Buffers that held only compressed data or none (meshopt's fallback) stay in place so that numbers keep
///   their meaning.
/// - Every buffer holds exactly its byteLength, every used bufferView lies inside its buffer; `Buffer::uri`
/// is kept.
/// - Pictures are not decoded: `Image::image` holds the encoded bytes (`as_is` is set), from whatever place;
/// it is
///   empty when the file of the picture is missing, which is no error here.
/// - Numbers of accessors, nodes and the rest are as the file has them: unchecked.
/// Errors have code kBadInput, `file`, and a place where there is one; no exception leaves.
Result<tinygltf::Model> load_gltf_model(const std::string& file);

}  // namespace goldthread
