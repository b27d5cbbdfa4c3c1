#include "files/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "files/gltf_builder.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

std::string content(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

size_t entries(const std::string& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, AppearsOnlyOnCommit) {
  const TempFolder folder;
  const std::string file = folder.write("out.txt", "old");
  Result<AtomicFile> output = AtomicFile::create(file);
  ASSERT_TRUE(output) << output.error().line();
  ASSERT_TRUE(output->write("new"));
  ASSERT_TRUE(output->flush());
  EXPECT_EQ(content(file), "old");
  ASSERT_TRUE(output->commit());
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(entries(folder.path("")), 1u);
}

TEST(AtomicFile, LeavesNothingBehindWhenDropped) {
  const TempFolder folder;
  {
    Result<AtomicFile> output = AtomicFile::create(folder.path("out.txt"));
    ASSERT_TRUE(output);
    ASSERT_TRUE(output->write("half"));
    EXPECT_EQ(entries(folder.path("")), 1u);
  }
  EXPECT_EQ(entries(folder.path("")), 0u);
}

TEST(AtomicFile, KeepsTheModeAndTheLinkOfWhatItReplaces) {
  const TempFolder folder;
  const std::string file = folder.write("real.txt", "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.txt", folder.path("link.txt"));
  const std::string bytes = "new";
  ASSERT_TRUE(
      write_file_atomically(folder.path("link.txt"), {reinterpret_cast<const uint8_t*>(bytes.data()), 3}));
  EXPECT_TRUE(fs::is_symlink(folder.path("link.txt")));
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(AtomicFile, SaysWhatIsWrongWithThePlace) {
  const TempFolder folder;
  const Result<AtomicFile> missing = AtomicFile::create(folder.path("no/such/out.glb"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(missing.error().file, folder.path("no/such/out.glb"));
  EXPECT_EQ(missing.error().cure, "create the folder first");
  const Result<AtomicFile> is_folder = AtomicFile::create(folder.path(""));
  ASSERT_FALSE(is_folder);
  EXPECT_EQ(is_folder.error().cure, "give a file name, not a folder");
  EXPECT_FALSE(AtomicFile::create(""));
  EXPECT_FALSE(
      AtomicFile::create("/proc/out.glb"));  // a folder in which nobody may make files, not even root
}

TEST(AtomicFile, WritesDevicesDirectlyAndReportsAFullOne) {
  const std::vector<uint8_t> bytes(100, 1);
  EXPECT_TRUE(write_file_atomically("/dev/null", bytes));
  const Status full = write_file_atomically("/dev/full", bytes);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(full.error().file, "/dev/full");
  EXPECT_EQ(full.error().cure, "free some space or write to another disk");
  struct stat device = {};
  ASSERT_EQ(::stat("/dev/full", &device), 0);
  EXPECT_TRUE(S_ISCHR(device.st_mode));
}

TEST(AtomicFile, KeepsTheOldFileWhenTheNewOneGrowsTooLarge) {
  const TempFolder folder;
  const std::string file = folder.write("out.bin", "old");
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small = {4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status status = write_file_atomically(file, std::vector<uint8_t>(100000, 7));
  ::setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(content(file), "old");
  EXPECT_EQ(entries(folder.path("")), 1u);
}

}  // namespace
}  // namespace goldthread
