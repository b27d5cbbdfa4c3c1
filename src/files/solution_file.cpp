#include "files/solution_file.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cerrno>
#include <memory>
#include <new>
#include <optional>

#include "files/atomic_file.h"
#include "files/solution_archive.h"

namespace goldthread {
namespace {

constexpr int kApplicationId = 0x676f6c64;  // "gold"
constexpr int kFormatVersion = 3;
constexpr size_t kPartBytes = size_t{64} << 20;  // far below SQLite's limit for one value
constexpr const char* kCure = "bake the scene again";

Error unreadable(const std::string& file, std::string place, std::string message, std::string cure = kCure) {
  return {ErrorCode::kBadInput, std::move(message), file, std::move(place), std::move(cure)};
}

/// FNV-1a, 64 bits: against accidents, not against forgery.
uint64_t checksum(const uint8_t* bytes, size_t size) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

Database open_database(const std::string& file, int flags) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags, nullptr);
  Database database(handle);  // to be closed even when opening failed
  if (code != SQLITE_OK) database.reset();
  return database;
}

Statement prepare(sqlite3* database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, sql.c_str(), static_cast<int>(sql.size()), &statement, nullptr);
  return Statement(statement);
}

bool execute(sqlite3* database, const std::string& sql) {
  return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

std::optional<int64_t> query_number(sqlite3* database, const std::string& sql) {
  const Statement statement = prepare(database, sql);
  if (!statement || sqlite3_step(statement.get()) != SQLITE_ROW) return std::nullopt;
  return sqlite3_column_int64(statement.get(), 0);
}

/// No journal and no flushes: the file has a temporary name until it is whole. Fixed settings, a fixed order
/// and no dates make the bytes a function of the content.
bool prepare_for_writing(sqlite3* database) {
  return execute(database,
                 "PRAGMA page_size=16384; PRAGMA auto_vacuum=NONE; PRAGMA encoding='UTF-8';"
                 "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA locking_mode=EXCLUSIVE;"
                 "PRAGMA temp_store=MEMORY;") &&
         execute(database, fmt::format("PRAGMA application_id={}; PRAGMA user_version={};", kApplicationId,
                                       kFormatVersion)) &&
         execute(database,
                 "BEGIN;"
                 "CREATE TABLE sections(name TEXT PRIMARY KEY NOT NULL, size INTEGER NOT NULL);"
                 "CREATE TABLE parts(section TEXT NOT NULL, part INTEGER NOT NULL, checksum INTEGER NOT NULL,"
                 " bytes BLOB NOT NULL, PRIMARY KEY(section, part));");
}

bool insert_part(sqlite3_stmt* insert, const std::string& name, size_t part, const uint8_t* bytes,
                 size_t size) {
  sqlite3_reset(insert);
  sqlite3_bind_text(insert, 1, name.c_str(), -1, SQLITE_STATIC);
  sqlite3_bind_int64(insert, 2, static_cast<sqlite3_int64>(part));
  sqlite3_bind_int64(insert, 3, static_cast<sqlite3_int64>(checksum(bytes, size)));
  sqlite3_bind_blob64(insert, 4, bytes, size, SQLITE_STATIC);
  const bool done = sqlite3_step(insert) == SQLITE_DONE;
  sqlite3_clear_bindings(insert);
  return done;
}

bool write_sections(sqlite3* database, const Solution& solution) {
  const Statement section = prepare(database, "INSERT INTO sections VALUES(?, ?)");
  const Statement insert = prepare(database, "INSERT INTO parts VALUES(?, ?, ?, ?)");
  if (!section || !insert) return false;
  for (const std::string& name : section_names()) {
    const std::vector<uint8_t> bytes = pack_section(solution, name);
    if (bytes.empty() && is_optional_section(name)) continue;
    sqlite3_reset(section.get());
    sqlite3_bind_text(section.get(), 1, name.c_str(), -1, SQLITE_STATIC);
    sqlite3_bind_int64(section.get(), 2, static_cast<sqlite3_int64>(bytes.size()));
    if (sqlite3_step(section.get()) != SQLITE_DONE) return false;
    for (size_t part = 0; part * kPartBytes < bytes.size(); ++part) {
      const size_t start = part * kPartBytes, size = std::min(kPartBytes, bytes.size() - start);
      if (!insert_part(insert.get(), name, part, bytes.data() + start, size)) return false;
    }
  }
  return true;
}

/// SQLite's code where the system gave none.
int error_number(sqlite3* database) {
  if (sqlite3_errcode(database) == SQLITE_FULL) return ENOSPC;
  const int system = sqlite3_system_errno(database);
  return system != 0 ? system : EIO;
}

Status check_header(sqlite3* database, const std::string& file) {
  const auto id = query_number(database, "PRAGMA application_id");
  if (!id || *id != kApplicationId)
    return unreadable(file, "", "is not a goldthread solution", "give a .gold file");
  const auto version = query_number(database, "PRAGMA user_version");
  if (!version || *version != kFormatVersion)
    return unreadable(file, "",
                      fmt::format("is of format version {}; this program reads version {}",
                                  version.value_or(0), kFormatVersion));
  return Nothing{};
}

/// The size of a section, once the file is known to hold that many bytes of it.
Result<size_t> section_size(sqlite3* database, const std::string& file, const std::string& name) {
  const auto stated = query_number(database, "SELECT size FROM sections WHERE name='" + name + "'");
  const auto held = query_number(
      database, "SELECT coalesce(sum(length(bytes)), 0) FROM parts WHERE section='" + name + "'");
  if (!stated || !held) return unreadable(file, name, "is missing");
  if (*stated < 0 || *stated != *held)
    return unreadable(file, name, fmt::format("states {} bytes and holds {}", *stated, *held));
  return static_cast<size_t>(*stated);
}

Result<std::vector<uint8_t>> read_section(sqlite3* database, const std::string& file,
                                          const std::string& name) {
  const Result<size_t> size = section_size(database, file, name);
  if (!size) return size.error();
  std::vector<uint8_t> bytes;
  bytes.reserve(*size);
  const Statement parts =
      prepare(database, "SELECT part, checksum, bytes FROM parts WHERE section='" + name + "' ORDER BY part");
  if (!parts) return unreadable(file, name, "is missing");
  int code = SQLITE_ROW;
  for (int64_t expected = 0; (code = sqlite3_step(parts.get())) == SQLITE_ROW; ++expected) {
    const auto* data = static_cast<const uint8_t*>(sqlite3_column_blob(parts.get(), 2));
    const auto count = static_cast<size_t>(sqlite3_column_bytes(parts.get(), 2));
    const auto sum = static_cast<uint64_t>(sqlite3_column_int64(parts.get(), 1));
    if (sqlite3_column_int64(parts.get(), 0) != expected) return unreadable(file, name, "lacks a part");
    if (checksum(data, count) != sum)
      return unreadable(file, fmt::format("{} part {}", name, expected),
                        "has a wrong checksum: the file is damaged");
    bytes.insert(bytes.end(), data, data + count);
  }
  if (code != SQLITE_DONE || bytes.size() != *size) return unreadable(file, name, "cannot be read whole");
  return bytes;
}

Result<Solution> read_all(const std::string& file) {
  const Database database = open_database(file, SQLITE_OPEN_READONLY);
  if (!database) return unreadable(file, "", "cannot be opened", "check its name and permissions");
  // The file may be anybody's: no code of its schema runs, and a broken page is an error, not a crash.
  execute(database.get(), "PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON;");
  if (Status status = check_header(database.get(), file); !status) return status.error();
  Solution solution;
  for (const std::string& name : section_names()) {
    if (is_optional_section(name) &&
        !query_number(database.get(), "SELECT size FROM sections WHERE name='" + name + "'"))
      continue;
    const Result<std::vector<uint8_t>> bytes = read_section(database.get(), file, name);
    if (!bytes) return bytes.error();
    if (!unpack_section(solution, name, *bytes))
      return unreadable(file, name, "has a count or a value that does not fit");
  }
  if (const std::string problem = find_contradiction(solution); !problem.empty())
    return unreadable(file, "", problem);
  return solution;
}

}  // namespace

Status write_solution(const std::string& file, const Solution& solution) {
  Result<AtomicFile> output = AtomicFile::create(file);
  if (!output) return output.error();
  sqlite3* handle = nullptr;
  const int opened =
      sqlite3_open_v2(output->temporary_path().c_str(), &handle, SQLITE_OPEN_READWRITE, nullptr);
  Database database(handle);
  if (opened != SQLITE_OK) return output->failure(handle ? error_number(handle) : ENOMEM);
  const bool written =
      prepare_for_writing(handle) && write_sections(handle, solution) && execute(handle, "COMMIT;");
  if (!written) return output->failure(error_number(handle));
  database.reset();
  return output->commit();
}

Result<Solution> read_solution(const std::string& file) {
  try {
    return read_all(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "out of memory while reading", file, "", "close other programs"};
  }
}

}  // namespace goldthread
