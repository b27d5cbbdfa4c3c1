// What a file's name says about it.
#pragma once
#include <cctype>
#include <filesystem>
#include <string>

namespace goldthread {

/// With its dot and in lower case, as ".glb"; empty when there is none.
inline std::string file_extension(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace goldthread
