// Reader of the shared collection's accuracy cases, which are JSON: exact form factors, rooms of known light.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "math/vec.h"

namespace goldthread::test {

using Json = nlohmann::json;

/// All cases of accuracy/`name`, or null where the collection is not there: tests are skipped then.
inline Json shared_cases(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(GOLDTHREAD_SHARED) / "accuracy" / name;
  if (!std::filesystem::exists(file)) return {};
  return Json::parse(std::ifstream(file))["cases"];
}

/// The one of that id, or null where the collection is not there. A failure of the test if it has no such.
inline Json shared_case(const std::string& name, const std::string& id) {
  const Json cases = shared_cases(name);
  if (cases.is_null()) return {};
  for (const Json& c : cases)
    if (c["id"] == id) return c;
  ADD_FAILURE() << "there is no case " << id;
  return {};
}

/// A vec3 or dvec3 of three numbers.
template <typename Vector>
Vector vector_of(const Json& v) {
  using Number = typename Vector::value_type;
  return {v[0].get<Number>(), v[1].get<Number>(), v[2].get<Number>()};
}

/// The corners of a polygon.
template <typename Vector>
std::vector<Vector> corners_of(const Json& polygon) {
  std::vector<Vector> corners;
  for (const Json& v : polygon["vertices"]) corners.push_back(vector_of<Vector>(v));
  return corners;
}

/// For INSTANTIATE_TEST_SUITE_P: an id without the collection's prefix, such as "gi-p-", as tests may be
/// named.
struct CaseName {
  template <typename Info>
  std::string operator()(const Info& info) const {
    std::string name(info.param + 5);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
  }
};

/// What a test says that is skipped for want of the collection.
constexpr const char* kNoSharedCases = "the shared accuracy cases are not here";

}  // namespace goldthread::test
