// Outputs appear whole or not at all: written under a temporary name beside the target, flushed to disk,
// renamed.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "goldthread/error.h"

namespace goldthread {

/// One output being written. Unless `commit` succeeds, destruction removes the temporary file and leaves the
/// target as it was. A target that is a device or a pipe is written directly. All errors are kCannotWrite and
/// name the target, never the temporary name. A symbolic link stays a link: what it points to is replaced.
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::string& target);
  ~AtomicFile();
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;

  Status write(std::span<const uint8_t> bytes);
  Status write(const std::string& text);
  /// Flushes to disk and closes; what is left to `commit` can then hardly fail. For outputs of several files:
  /// flush all, then commit all.
  Status flush();
  /// `flush` unless done, then gives the file its name.
  Status commit();

  /// Where the bytes are until `commit`, for libraries that only write to a named file.
  const std::string& temporary_path() const { return temporary_; }
  /// What to answer when such a library could not write there, by its errno.
  Error failure(int error_number) const;

 private:
  AtomicFile() = default;
  void abandon() noexcept;

  std::string target_;     ///< as the caller named it, for messages
  std::string resolved_;   ///< with symbolic links followed
  std::string temporary_;  ///< empty once committed; equal to resolved_ when written directly
  int descriptor_ = -1;
};

/// All of it: create, write, commit.
Status write_file_atomically(const std::string& target, std::span<const uint8_t> bytes);

}  // namespace goldthread
