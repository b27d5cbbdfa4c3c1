#include "files/mesh_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>

#include "files/file_name.h"
#include "files/gltf_read_container.h"
#include "files/ply_check.h"

namespace goldthread {
namespace {

constexpr const char* kExtensions[] = {".obj", ".ply", ".stl", ".fbx", ".dae"};  // by MeshFormat

std::string_view text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The format that a file's first bytes give away; OBJ and binary STL have no mark.
std::optional<MeshFormat> marked_format(const Bytes& bytes) {
  const std::string_view start = text_of(bytes).substr(0, 1024);
  const auto begins = [&](std::string_view mark) { return start.substr(0, mark.size()) == mark; };
  const auto holds = [&](std::string_view mark) { return start.find(mark) != std::string_view::npos; };
  if (begins("Kaydara FBX Binary") || begins("; FBX")) return MeshFormat::kFbx;
  if (begins("ply\n") || begins("ply\r")) return MeshFormat::kPly;
  if (begins("solid") && holds("facet normal")) return MeshFormat::kStl;
  if (holds("<COLLADA")) return MeshFormat::kCollada;
  return std::nullopt;
}

/// How many numbers follow "v " on this line, before anything else.
size_t count_numbers(std::string_view line) {
  line.remove_prefix(2);
  for (size_t count = 0;; ++count) {
    const size_t start = line.find_first_not_of(" \t");
    if (start == line.npos) return count;
    line.remove_prefix(start + (line[start] == '+' ? 1 : 0));
    float value = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error == std::errc::invalid_argument) return count;
    line.remove_prefix(size_t(end - line.data()));
  }
}

/// OBJ files may give colours to some vertices only (Blender: to those of painted objects). assimp numbers
/// the colours by themselves, so they would land on the first vertices and leave the others black. And it
/// takes the words of a comment behind a vertex for numbers. Such a file is returned without those comments
/// and with white on all other vertices; nothing is returned for all others.
std::optional<Bytes> with_plain_vertices(const Bytes& bytes) {
  const std::string_view text = text_of(bytes);
  const auto each_line = [&](const auto& take) {
    for (size_t at = 0; at < text.size();) {
      const size_t end = std::min(text.find('\n', at), text.size());
      const std::string_view line = text.substr(at, end - at);
      take(line, line.size() > 2 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t'));
      at = end + 1;
    }
  };
  size_t coloured = 0, plain = 0, comments = 0;
  each_line([&](std::string_view line, bool is_vertex) {
    if (!is_vertex) return;
    ++(count_numbers(line) >= 6 ? coloured : plain);
    if (line.find('#') != line.npos) ++comments;
  });
  if ((coloured == 0 || plain == 0) && comments == 0) return std::nullopt;
  Bytes out;
  out.reserve(bytes.size() + 6 * plain);
  each_line([&](std::string_view line, bool is_vertex) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (is_vertex) line = line.substr(0, line.find('#'));
    out.insert(out.end(), line.begin(), line.end());
    constexpr std::string_view kWhite = " 1 1 1";
    if (is_vertex && coloured > 0 && count_numbers(line) == 3)
      out.insert(out.end(), kWhite.begin(), kWhite.end());
    out.push_back('\n');
  });
  return out;
}

/// PLY files from old Macs end lines with a bare carriage return, which assimp does not know. Such a file is
/// returned with line feeds instead, in the header and, if the body is text, there as well; nothing is
/// returned for all others.
std::optional<Bytes> with_line_feeds(const Bytes& bytes) {
  const std::string_view text = text_of(bytes);
  if (text.substr(0, 4) != "ply\r" || text.substr(4, 1) == "\n") return std::nullopt;
  constexpr std::string_view kLastLine = "\rend_header\r";
  const size_t last = text.find(kLastLine);
  if (last == text.npos) return std::nullopt;
  const bool all = text.substr(0, last).find("\rformat ascii") != text.npos;
  Bytes out = bytes;
  std::replace(out.begin(), all ? out.end() : out.begin() + std::ptrdiff_t(last + kLastLine.size()),
               uint8_t('\r'), uint8_t('\n'));
  return out;
}

/// The disk, but for one file.
class PatchedFiles : public Assimp::DefaultIOSystem {
 public:
  PatchedFiles(std::string file, Bytes bytes) : file_(std::move(file)), bytes_(std::move(bytes)) {}

  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (file != file_) return DefaultIOSystem::Open(file, mode);
    return new Assimp::MemoryIOStream(bytes_.data(), bytes_.size());
  }

 private:
  std::string file_;
  Bytes bytes_;
};

/// assimp's own steps trust the indices, and end the program on faces without corners.
Status check_faces(const aiScene& scene, const std::string& file) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    const auto broken = [&](unsigned face, const std::string& message) {
      return bad_input(file, fmt::format("mesh {} face {}", m, face), message,
                       "the file may be cut off: copy or export it again");
    };
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 0) return broken(f, "has no corners");
      for (unsigned corner = 0; corner < face.mNumIndices; ++corner)
        if (face.mIndices[corner] >= mesh.mNumVertices)
          return broken(f, fmt::format("names vertex {} of {}", face.mIndices[corner], mesh.mNumVertices));
    }
  }
  return Nothing{};
}

}  // namespace

MeshFormat mesh_format(const std::string& file) {
  const std::string extension = file_extension(file);
  const auto found = std::find(std::begin(kExtensions), std::end(kExtensions), extension);
  return found == std::end(kExtensions) ? MeshFormat::kObj : MeshFormat(found - std::begin(kExtensions));
}

Result<const aiScene*> import_mesh_file(const std::string& file, Assimp::Importer& importer) {
  // Opened first for a plain message, and so that assimp never sees a device or a folder.
  Result<Bytes> bytes = read_file_bytes(file);
  if (!bytes) return bytes.error();
  if (bytes->empty()) return bad_input(file, "", "the file is empty", "export it again");
  const MeshFormat format = mesh_format(file);
  if (const auto marked = marked_format(*bytes); marked && *marked != format)
    return bad_input(file, "", fmt::format("its content is that of a {} file", kExtensions[size_t(*marked)]),
                     fmt::format("give it a name that ends in {}", kExtensions[size_t(*marked)]));
  std::optional<Bytes> patched;
  if (format == MeshFormat::kPly) {
    patched = with_line_feeds(*bytes);
    if (Status status = check_ply_length(text_of(patched ? *patched : *bytes), file); !status)
      return status.error();
  }
  if (format == MeshFormat::kObj) patched = with_plain_vertices(*bytes);
  if (patched) importer.SetIOHandler(new PatchedFiles(file, *std::move(patched)));  // the importer owns it
  *bytes = Bytes();
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(file, 0);
  if (!scene)
    return bad_input(file, "",
                     fmt::format("assimp cannot read it: {}", plain_text(importer.GetErrorString())),
                     "export the file again, best as glTF");
  if (scene->mNumMeshes == 0) return scene;
  if (Status status = check_faces(*scene, file); !status) return status.error();
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                       aiProcess_SortByPType | aiProcess_GlobalScale);
  if (!scene || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE))
    return bad_input(file, "",
                     fmt::format("assimp cannot read it: {}", plain_text(importer.GetErrorString())),
                     "export the file again, best as glTF");
  return scene;
}

std::string plain_text(const std::string& text) {
  constexpr size_t kLongest = 200;
  std::string out = text.substr(0, kLongest);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = c == '\n' || c == '\t' ? ' ' : '?';
  return text.size() > kLongest ? out + "..." : out;
}

}  // namespace goldthread
