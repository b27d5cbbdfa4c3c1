#include "files/npz_write.h"

#include <fmt/format.h>
#include <zip.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>

#include "files/atomic_file.h"

namespace goldthread {
namespace {

static_assert(std::endian::native == std::endian::little, "array types below name little-endian numbers");

struct Bytes {
  const void* data;
  size_t size;
  std::string type, shape;
};

template <typename T>
Bytes bytes_of(std::span<const T> values, const char* type) {
  return {values.data(), values.size_bytes(), type, fmt::format("({},)", values.size())};
}

struct Describe {
  Bytes operator()(std::span<const double> v) const { return bytes_of(v, "<f8"); }
  Bytes operator()(std::span<const int64_t> v) const { return bytes_of(v, "<i8"); }
  Bytes operator()(std::span<const float> v) const { return bytes_of(v, "<f4"); }
  Bytes operator()(const std::string& v) const {
    return {v.data(), v.size(), fmt::format("|S{}", v.size()), "()"};
  }
};

// The .npy format, version 1.0: magic, length of the header, a Python literal padded to 64 bytes.
std::string npy_header(const Bytes& bytes) {
  std::string literal =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", bytes.type, bytes.shape);
  constexpr size_t kBefore = 10;
  literal.append(63 - (kBefore + literal.size()) % 64, ' ');
  literal += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(literal.size() & 0xff);
  header += static_cast<char>(literal.size() >> 8);
  return header + literal;
}

using Zip = std::unique_ptr<zip_t, void (*)(zip_t*)>;

bool add(zip_t* zip, const NpzArray& array) {
  const Bytes bytes = std::visit(Describe(), array.values);
  const std::string header = npy_header(bytes);
  // libzip reads when the archive is closed: it is given a copy of its own, which it frees.
  auto* const copy = static_cast<char*>(std::malloc(header.size() + bytes.size));
  if (copy == nullptr) throw std::bad_alloc();
  std::memcpy(copy, header.data(), header.size());
  if (bytes.size > 0) std::memcpy(copy + header.size(), bytes.data, bytes.size);
  zip_source_t* source = zip_source_buffer(zip, copy, header.size() + bytes.size, 1);
  if (source == nullptr) {
    std::free(copy);
    return false;
  }
  const zip_int64_t index = zip_file_add(zip, (array.name + ".npy").c_str(), source, ZIP_FL_OVERWRITE);
  if (index < 0) {
    zip_source_free(source);
    return false;
  }
  // As NumPy's own savez: not compressed, and without a date, so that the same arrays give the same bytes.
  zip_file_set_mtime(zip, static_cast<zip_uint64_t>(index), 0, 0);
  return zip_set_file_compression(zip, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0) == 0;
}

}  // namespace

Status write_npz(const std::string& file, std::span<const NpzArray> arrays) {
  Result<AtomicFile> out = AtomicFile::create(file);
  if (!out) return out.error();
  int code = 0;
  Zip zip(zip_open(out->temporary_path().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code), zip_discard);
  if (!zip) return out->failure(errno);
  for (const NpzArray& array : arrays)
    if (!add(zip.get(), array)) return out->failure(zip_error_code_system(zip_get_error(zip.get())));
  if (zip_close(zip.get()) != 0) return out->failure(zip_error_code_system(zip_get_error(zip.get())));
  static_cast<void>(zip.release());  // closed
  return out->commit();
}

}  // namespace goldthread
