#include "mesh/dual_graph.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "mesh/components.h"
#include "mesh/shapes.h"
#include "mesh/validate.h"

namespace goldthread {
namespace {

std::vector<uint32_t> twins_of(const TriangleMesh& mesh) {
  std::vector<uint32_t> twins = find_twins(mesh);
  validate_twins(mesh, twins);
  return twins;
}

size_t unpaired(const std::vector<uint32_t>& twins) {
  return size_t(std::count(twins.begin(), twins.end(), kNoTwin));
}

/// Triangles on one edge (0, 1): forward ones run 0 to 1, the others 1 to 0.
shapes::Soup book(const std::vector<bool>& forward) {
  shapes::Soup soup;
  soup.positions = {{0, 0, 0}, {0, 0, 1}};
  for (const bool f : forward) {
    const float angle = float(soup.positions.size());
    const uint32_t page = uint32_t(soup.positions.size());
    soup.positions.push_back({std::cos(angle), std::sin(angle), 0});
    f ? soup.triangle(0, 1, page) : soup.triangle(1, 0, page);
  }
  return soup;
}

TEST(DualGraph, ACubeIsClosed) {
  const TriangleMesh mesh = shapes::cube(3).weld();
  const auto twins = twins_of(mesh);
  EXPECT_EQ(unpaired(twins), 0u);
  for (size_t h = 0; h < twins.size(); ++h)  // consistent winding: twins run opposite ways
    EXPECT_EQ(mesh.triangles[h / 3][int(h % 3)], mesh.triangles[twins[h] / 3][int((twins[h] % 3 + 1) % 3)]);
}

TEST(DualGraph, AGridHasABorder) {
  EXPECT_EQ(unpaired(twins_of(shapes::flat_grid(5).weld())), 20u);
}

TEST(DualGraph, PagesOfABookArePairedOppositesFirst) {
  {
    const auto twins = twins_of(book({true, true, false}).weld());
    EXPECT_EQ(twins[0], 6u);
    EXPECT_EQ(twins[3], kNoTwin);
  }
  {
    const auto twins = twins_of(book({true, false, false, true}).weld());
    EXPECT_EQ(twins[0], 3u);
    EXPECT_EQ(twins[9], 6u);
  }
  {
    const auto twins = twins_of(book({true, true, true, false, true}).weld());
    EXPECT_EQ(twins[0], 9u);  // the only opposite goes to the first
    EXPECT_EQ(twins[3], 6u);  // what is left pairs with its like
    EXPECT_EQ(twins[12], kNoTwin);
  }
}

TEST(DualGraph, AMoebiusStripHasFlippedNeighbours) {
  const TriangleMesh mesh = shapes::moebius(12).weld();
  const auto twins = twins_of(mesh);
  EXPECT_EQ(unpaired(twins), 24u);
  EXPECT_EQ(find_components(twins).count, 1u);
}

TEST(DualGraph, BackToBackSheetsMeetAtTheRimOnly) {
  shapes::Soup sheet = shapes::flat_grid(4);
  const std::vector<uint32_t> front = sheet.indices;
  for (size_t i = 0; i < front.size(); i += 3) sheet.triangle(front[i], front[i + 2], front[i + 1]);
  const TriangleMesh mesh = sheet.weld();
  const Components components = find_components(twins_of(mesh));
  // Inside, each sheet pairs with itself; at the border the two meet and are one surface, closed round the
  // rim.
  EXPECT_EQ(components.count, 1u);
}

TEST(DualGraph, AFanRoundOneVertexIsARing) {
  const auto twins = twins_of(shapes::fan(100000).weld());
  EXPECT_EQ(unpaired(twins), 100000u);
  EXPECT_EQ(find_components(twins).count, 1u);
}

TEST(Components, NumberedByFirstTriangle) {
  shapes::Soup soup = shapes::strip(5);
  const uint32_t n = uint32_t(soup.positions.size());
  for (const vec3& p : shapes::strip(5).positions) soup.positions.push_back(p + vec3(0, 5, 0));
  for (const uint32_t i : shapes::strip(5).indices) soup.indices.push_back(i + n);
  const Components components = find_components(find_twins(soup.weld()));
  EXPECT_EQ(components.count, 2u);
  EXPECT_EQ(components.of_triangle, (std::vector<uint32_t>{0, 0, 0, 0, 0, 1, 1, 1, 1, 1}));
}

RC_GTEST_PROP(DualGraph, AnySoupIsPairedAsFarAsItGoes, (uint32_t seed)) {
  const auto triangles = *rc::gen::inRange<uint32_t>(0, 400), vertices = *rc::gen::inRange<uint32_t>(3, 60);
  const TriangleMesh mesh = shapes::random_soup(seed, triangles, vertices).weld();
  const auto twins = twins_of(mesh);
  std::map<std::pair<uint32_t, uint32_t>, int> single;  // at most one half-edge of an edge can be left over
  for (size_t h = 0; h < twins.size(); ++h) {
    const UVec3& t = mesh.triangles[h / 3];
    const auto ends = std::minmax(t[int(h % 3)], t[int((h % 3 + 1) % 3)]);
    if (twins[h] == kNoTwin) RC_ASSERT((++single[{ends.first, ends.second}] == 1));
  }
  const Components components = find_components(twins);
  uint32_t seen = 0;
  for (size_t h = 0; h < twins.size(); ++h) {
    const uint32_t mine = components.of_triangle[h / 3];
    if (twins[h] != kNoTwin) RC_ASSERT(components.of_triangle[twins[h] / 3] == mine);
    RC_ASSERT(mine <= seen);
    seen = std::max(seen, mine + 1);
  }
  RC_ASSERT(seen == components.count);
}

}  // namespace
}  // namespace goldthread
