#include "files/gltf_load.h"

#include <fmt/format.h>

#include "files/gltf_read_compression.h"
#include "files/gltf_read_container.h"
#include "files/gltf_read_json.h"

namespace goldthread {
namespace {

/// Fills buffer `index`, whose uri is set, and cuts it to the length that the file states.
Status load_buffer(const nlohmann::json& declared, const GltfChunks& chunks, const std::string& file,
                   size_t index, tinygltf::Buffer& buffer) {
  const std::string place = fmt::format("buffer {}", index);
  const uint64_t length = declared["byteLength"];
  if (!buffer.uri.empty()) {
    Result<Bytes> bytes = fetch_uri(buffer.uri, file);
    if (!bytes) return bad_input(file, place, bytes.error().message, bytes.error().cure);
    buffer.data = *std::move(bytes);
  } else if (index == 0 && !chunks.binary.empty() && !is_meshopt_fallback(declared)) {
    buffer.data.assign(chunks.binary.begin(), chunks.binary.end());
  } else if (is_meshopt_fallback(declared)) {
    return Nothing{};  // its views come out of the decoder
  } else if (length > 0) {
    return bad_input(file, place, "it has no uri and the file has no binary chunk for it",
                     "export the file again");
  }
  if (buffer.data.size() < length)
    return bad_input(file, place, fmt::format("it holds {} of its {} bytes", buffer.data.size(), length),
                     "copy or export the file again");
  buffer.data.resize(length);
  return Nothing{};
}

/// Whether the view's bytes exist. Compressed views are looked at by their decoder instead.
Status check_buffer_view(const tinygltf::Model& model, size_t index, const std::string& file) {
  const tinygltf::BufferView& view = model.bufferViews[index];
  if (is_meshopt_view(view)) return Nothing{};
  const std::string place = fmt::format("bufferView {}", index);
  if (size_t(view.buffer) >= model.buffers.size())
    return bad_input(file, place, fmt::format("there is no buffer {}", view.buffer), "export the file again");
  const size_t size = model.buffers[size_t(view.buffer)].data.size();
  if (view.byteOffset > size || view.byteLength > size - view.byteOffset)
    return bad_input(file, place,
                     fmt::format("bytes {} and {} more lie beyond its buffer's {}", view.byteOffset,
                                 view.byteLength, size),
                     "copy or export the file again");
  return Nothing{};
}

/// Encoded bytes of a picture, from wherever it is. What cannot be had stays empty: textures are not worth
/// failing.
void load_image(const tinygltf::Model& model, const std::string& file, tinygltf::Image& image) {
  if (image.bufferView >= 0) {
    if (size_t(image.bufferView) >= model.bufferViews.size()) return;
    const tinygltf::BufferView& view = model.bufferViews[size_t(image.bufferView)];
    const std::vector<unsigned char>& data = model.buffers[size_t(view.buffer)].data;
    const auto begin = data.begin() + std::ptrdiff_t(view.byteOffset);
    image.image.assign(begin, begin + std::ptrdiff_t(view.byteLength));
  } else if (!image.uri.empty()) {
    if (image.mimeType.empty()) image.mimeType = data_uri_type(image.uri);
    if (Result<Bytes> bytes = fetch_uri(image.uri, file)) image.image = *std::move(bytes);
    if (image.uri.rfind("data:", 0) == 0) image.uri.clear();  // as tinygltf does: the bytes are held
  }
}

Result<tinygltf::Model> load(const std::string& file) {
  const Result<Bytes> bytes = read_file_bytes(file);
  if (!bytes) return bytes.error();
  const Result<GltfChunks> chunks = split_gltf(*bytes, file);
  if (!chunks) return chunks.error();
  const Result<nlohmann::json> json = parse_gltf_json(chunks->json, file);
  if (!json) return json.error();
  Result<tinygltf::Model> model = build_gltf_model(*json, file);
  if (!model) return model;
  for (size_t i = 0; i < model->buffers.size(); ++i)
    if (Status status = load_buffer((*json)["buffers"][i], *chunks, file, i, model->buffers[i]); !status)
      return status.error();
  for (size_t i = 0; i < model->bufferViews.size(); ++i)
    if (Status status = check_buffer_view(*model, i, file); !status) return status.error();
  if (Status status = expand_compression(*model, file); !status) return status.error();
  for (tinygltf::Image& image : model->images) load_image(*model, file, image);
  return model;
}

}  // namespace

Result<tinygltf::Model> load_gltf_model(const std::string& file) {
  try {
    return load(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "out of memory while reading", file, "", "close other programs"};
  } catch (const std::exception& problem) {
    return bad_input(file, "", problem.what(), "export the file again");
  }
}

}  // namespace goldthread
