// .npz files as NumPy reads them.
#include "files/npz_write.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zip.h>

#include <cstring>
#include <map>

#include "files/gltf_builder.h"

namespace goldthread {
namespace {

using test::TempFolder;

std::map<std::string, std::string> entries_of(const std::string& file) {
  std::map<std::string, std::string> out;
  int code = 0;
  zip_t* zip = zip_open(file.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code);
  if (zip == nullptr) throw std::runtime_error("not a zip file");
  for (zip_int64_t i = 0; i < zip_get_num_entries(zip, 0); ++i) {
    zip_stat_t stat;
    zip_stat_index(zip, zip_uint64_t(i), 0, &stat);
    zip_file_t* entry = zip_fopen_index(zip, zip_uint64_t(i), 0);
    std::string bytes(stat.size, '\0');
    EXPECT_EQ(zip_fread(entry, bytes.data(), stat.size), zip_int64_t(stat.size));
    zip_fclose(entry);
    out[stat.name] = bytes;
  }
  zip_close(zip);
  return out;
}

TEST(Npz, ArraysWithTheirHeaders) {
  const TempFolder folder;
  const std::vector<double> values{0.5, -2};
  const std::vector<int64_t> numbers{7};
  const std::vector<float> none;
  const std::vector<NpzArray> arrays{{"data", std::span<const double>(values)},
                                     {"indices", std::span<const int64_t>(numbers)},
                                     {"empty", std::span<const float>(none)},
                                     {"format", std::string("csr")}};
  ASSERT_TRUE(write_npz(folder.path("a.npz"), arrays));
  const auto entries = entries_of(folder.path("a.npz"));
  ASSERT_EQ(entries.size(), 4u);
  const std::string& data = entries.at("data.npy");
  // NEP 1: magic, version 1.0, length of a header that ends in a line feed on a multiple of 64 bytes.
  ASSERT_EQ(data.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const size_t length = static_cast<unsigned char>(data[8]) + 256u * static_cast<unsigned char>(data[9]);
  EXPECT_EQ((10 + length) % 64, 0u);
  EXPECT_EQ(data[10 + length - 1], '\n');
  EXPECT_THAT(data, ::testing::HasSubstr("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }"));
  ASSERT_EQ(data.size(), 10 + length + 16);
  double back[2];
  std::memcpy(back, data.data() + 10 + length, 16);
  EXPECT_EQ(back[0], 0.5);
  EXPECT_EQ(back[1], -2);
  EXPECT_THAT(entries.at("format.npy"), ::testing::HasSubstr("'|S3'"));
  EXPECT_THAT(entries.at("format.npy"), ::testing::EndsWith("csr"));
  EXPECT_THAT(entries.at("empty.npy"), ::testing::HasSubstr("'shape': (0,)"));
}

TEST(Npz, TheSameBytesAgain) {
  const TempFolder folder;
  const std::vector<double> values{1, 2, 3};
  const std::vector<NpzArray> arrays{{"data", std::span<const double>(values)}};
  ASSERT_TRUE(write_npz(folder.path("a.npz"), arrays));
  ASSERT_TRUE(write_npz(folder.path("b.npz"), arrays));
  EXPECT_EQ(entries_of(folder.path("a.npz")), entries_of(folder.path("b.npz")));
}

TEST(Npz, WhereNothingCanBeWritten) {
  const std::vector<NpzArray> arrays;
  const Status status = write_npz("/nowhere/at/all.npz", arrays);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kCannotWrite);
}

}  // namespace
}  // namespace goldthread
