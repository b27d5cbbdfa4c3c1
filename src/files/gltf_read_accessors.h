// What a glTF accessor holds, as plain vectors. Every count, offset and index is checked before memory is
// taken.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "files/gltf_load.h"
#include "goldthread/error.h"
#include "math/vec.h"

namespace goldthread {

/// Reads the accessors of one model. Keeps count of what it has handed out, so that a small file cannot ask
/// for the same data without end: the limit grows with the size of the file's buffers.
class AccessorReader {
 public:
  /// Both must outlive the reader.
  AccessorReader(const tinygltf::Model& model, const std::string& file);

  /// Elements as floats, `components` each and one after the other. Integers are divided by their range's end
  /// if the accessor says `normalized` or `normalize` is set, else taken as they are. Sparse accessors are
  /// filled in; those without a bufferView start from zeros. `components` must be the accessor's own (1 to
  /// 16).
  Result<std::vector<float>> floats(int accessor, int components, bool normalize = false);

  Result<std::vector<vec2>> vec2s(int accessor);
  Result<std::vector<vec3>> vec3s(int accessor);
  Result<std::vector<vec4>> vec4s(int accessor, bool normalize = false);
  Result<std::vector<mat4>> mat4s(int accessor);

  /// Whole numbers: scalars of unsigned type for vertex indices, 4 components for joints.
  Result<std::vector<uint32_t>> integers(int accessor, int components);

  /// Components per element (3 for VEC3), or an Error if there is no such accessor.
  Result<int> components(int accessor) const;
  Result<size_t> count(int accessor) const;

  /// Takes `bytes` from what may still be handed out: an Error if that is too much.
  Status spend(size_t bytes, const std::string& place);

  const tinygltf::Model& model() const { return model_; }
  const std::string& file() const { return file_; }

 private:
  /// Raw elements in memory: `count` of `size` bytes, `stride` apart.
  struct Raw {
    std::span<const unsigned char> bytes;
    size_t stride = 0, count = 0;
  };

  Result<const tinygltf::Accessor*> find(int accessor, int components) const;
  Result<Raw> locate(int buffer_view, size_t offset, size_t element, size_t count, bool packed,
                     const std::string& place) const;
  template <typename T, typename Convert>
  Result<std::vector<T>> read(int accessor, int components, Convert convert);
  template <typename T, typename Convert>
  Status overlay_sparse(const tinygltf::Accessor& accessor, const std::string& place, std::vector<T>& values,
                        Convert convert) const;

  const tinygltf::Model& model_;
  const std::string& file_;
  std::string unknown_;  ///< a required extension that may be where data without bufferView is
  size_t left_;          ///< bytes that may still be handed out
};

}  // namespace goldthread
