#include "files/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace goldthread {
namespace {

namespace fs = std::filesystem;

std::string cure_for(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or write to another disk";
    case EFBIG:
      return "raise the file size limit (ulimit -f) or write to another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder you may write to";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first";
    case EISDIR:
      return "give a file name, not a folder";
    case ENAMETOOLONG:
      return "choose a shorter name";
    default:
      return "choose another place to write to";
  }
}

Error cannot_write(const std::string& target, int error_number) {
  return {ErrorCode::kCannotWrite, std::string("cannot be written: ") + std::strerror(error_number), target,
          "", cure_for(error_number)};
}

/// Short, so that a target whose name is as long as the file system allows still works.
std::string temporary_name(const fs::path& target) {
  static std::atomic<uint32_t> counter{0};
  const std::string name =
      ".goldthread-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
  return (target.parent_path() / name).string();
}

/// So that the new name itself survives a power failure; not every file system can, hence no error.
void sync_folder(const std::string& file) {
  fs::path folder = fs::path(file).parent_path();
  if (folder.empty()) folder = ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::string& target) {
  AtomicFile file;
  file.target_ = target;
  if (target.empty()) return cannot_write(target, ENOENT);
  std::error_code ignored;
  const fs::path followed = fs::weakly_canonical(target, ignored);
  file.resolved_ = followed.empty() ? target : followed.string();

  struct stat existing = {};
  const bool exists = ::stat(file.resolved_.c_str(), &existing) == 0;
  if (exists && S_ISDIR(existing.st_mode)) return cannot_write(target, EISDIR);
  const bool direct = exists && !S_ISREG(existing.st_mode);
  // A rename needs only the folder's permission; a file made read-only is still to be respected.
  if (exists && !direct && ::access(file.resolved_.c_str(), W_OK) != 0) return cannot_write(target, errno);

  const std::string path = direct ? file.resolved_ : temporary_name(file.resolved_);
  const int flags = direct ? O_WRONLY : O_WRONLY | O_CREAT | O_EXCL;
  file.descriptor_ = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  if (file.descriptor_ < 0) return cannot_write(target, errno);
  file.temporary_ = path;
  // The umask decided the mode of a new file; one that is replaced keeps its own.
  if (exists && !direct && ::fchmod(file.descriptor_, existing.st_mode & 0777) != 0)
    return file.failure(errno);
  return file;
}

AtomicFile::~AtomicFile() {
  abandon();
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)),
      resolved_(std::move(other.resolved_)),
      temporary_(std::exchange(other.temporary_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this == &other) return *this;
  abandon();
  target_ = std::move(other.target_);
  resolved_ = std::move(other.resolved_);
  temporary_ = std::exchange(other.temporary_, {});
  descriptor_ = std::exchange(other.descriptor_, -1);
  return *this;
}

void AtomicFile::abandon() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!temporary_.empty() && temporary_ != resolved_) ::unlink(temporary_.c_str());
  temporary_.clear();
}

Error AtomicFile::failure(int error_number) const {
  return cannot_write(target_, error_number);
}

Status AtomicFile::write(std::span<const uint8_t> bytes) {
  constexpr size_t kAtOnce = size_t{1} << 30;  // Linux writes no more than 2 GiB a call
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), std::min(bytes.size(), kAtOnce));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failure(errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return Nothing{};
}

Status AtomicFile::write(const std::string& text) {
  return write({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

Status AtomicFile::flush() {
  if (descriptor_ < 0) return Nothing{};
  const int descriptor = std::exchange(descriptor_, -1);
  // Pipes and terminals cannot be synchronised (EINVAL, ENOTSUP); that is no failure.
  int error_number = ::fsync(descriptor) == 0 ? 0 : errno;
  if (error_number == EINVAL || error_number == ENOTSUP || error_number == EROFS) error_number = 0;
  if (::close(descriptor) != 0 && error_number == 0) error_number = errno;
  if (error_number != 0) return failure(error_number);
  return Nothing{};
}

Status AtomicFile::commit() {
  if (Status flushed = flush(); !flushed) return flushed;
  if (temporary_ != resolved_) {
    if (::rename(temporary_.c_str(), resolved_.c_str()) != 0) return failure(errno);
    sync_folder(resolved_);
  }
  temporary_.clear();
  return Nothing{};
}

Status write_file_atomically(const std::string& target, std::span<const uint8_t> bytes) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return file.error();
  if (Status written = file->write(bytes); !written) return written;
  return file->commit();
}

}  // namespace goldthread
