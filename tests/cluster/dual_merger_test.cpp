#include "cluster/dual_merger.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Eigenvalues>
#include <map>
#include <random>
#include <set>

#include "mesh/dual_graph.h"
#include "mesh/shapes.h"

namespace goldthread {
namespace {

using Triangles = std::set<uint32_t>;

std::array<vec3, 3> corners(const TriangleMesh& mesh, uint32_t t) {
  const UVec3& v = mesh.triangles[t];
  return {mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]};
}

/// Calls body(a, b, length) for each pair of neighbours.
template <typename Body>
void for_neighbours(const TriangleMesh& mesh, const Body& body) {
  const std::vector<uint32_t> twins = find_twins(mesh);
  for (uint32_t h = 0; h < twins.size(); ++h) {
    if (twins[h] == kNoTwin || twins[h] < h) continue;
    const auto p = corners(mesh, h / 3);
    body(h / 3, twins[h] / 3, length(p[(h + 1) % 3] - p[h % 3]));
  }
}

/// The clusters that DualMerger forms, in order.
std::vector<Triangles> merge_fast(const TriangleMesh& mesh, float balance) {
  DualMerger merger;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto p = corners(mesh, t);
    merger.add_cluster(shape_of_triangle(p[0], p[1], p[2]), t | kTriangleBit, 1);
  }
  for_neighbours(mesh, [&](uint32_t a, uint32_t b, float length) { merger.add_boundary(a, b, length); });
  std::vector<Merge> merges;
  merger.run(balance, 1, 0, merges);
  std::vector<Triangles> clusters;
  for (const Merge& m : merges) {
    Triangles& cluster = clusters.emplace_back();
    for (const ClusterRef child : m.child) {
      if (is_triangle(child))
        cluster.insert(triangle_of(child));
      else
        cluster.insert(clusters[child].begin(), clusters[child].end());
    }
    EXPECT_EQ(cluster.size(), m.count);
  }
  return clusters;
}

/// The same by trying every edge in every step.
std::vector<Triangles> merge_slowly(const TriangleMesh& mesh, float balance) {
  std::map<uint32_t, std::pair<Triangles, ClusterShape>> live;
  std::map<std::pair<uint32_t, uint32_t>, float> edges;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto p = corners(mesh, t);
    live[t] = {{t}, shape_of_triangle(p[0], p[1], p[2])};
  }
  for_neighbours(mesh, [&](uint32_t a, uint32_t b, float length) { edges[std::minmax({a, b})] += length; });
  std::vector<Triangles> clusters;
  while (!edges.empty()) {
    auto best = edges.begin();
    float least = std::numeric_limits<float>::infinity();
    for (auto e = edges.begin(); e != edges.end(); ++e) {
      const float cost =
          merge_cost(live[e->first.first].second, live[e->first.second].second, e->second, balance);
      if (cost < least) least = cost, best = e;
    }
    const auto [a, b] = best->first;
    live[a].second = merged(live[a].second, live[b].second, best->second);
    live[a].first.merge(live[b].first);
    clusters.push_back(live[a].first);
    live.erase(b);
    std::map<std::pair<uint32_t, uint32_t>, float> next;
    for (const auto& [ends, length] : edges) {
      const uint32_t from = ends.first == b ? a : ends.first, to = ends.second == b ? a : ends.second;
      if (from != to) next[std::minmax({from, to})] += length;
    }
    edges = std::move(next);
  }
  return clusters;
}

RC_GTEST_PROP(DualMerger, IsGreedyToTheLetter, (uint32_t seed)) {
  std::mt19937 random(seed);
  shapes::Soup soup = shapes::flat_grid(6);
  for (vec3& p : soup.positions)  // no two edges alike
    for (int k = 0; k < 3; ++k) p[k] += 0.05f * float(random() % 65536) / 65536;
  const TriangleMesh mesh = soup.weld();
  const float balance = *rc::gen::element(0.00001f, 0.001f, 0.1f);
  const auto fast = merge_fast(mesh, balance), slow = merge_slowly(mesh, balance);
  RC_ASSERT(std::set<Triangles>(fast.begin(), fast.end()) == std::set<Triangles>(slow.begin(), slow.end()));
}

RC_GTEST_PROP(FaceQuadric, FitErrorIsTheSmallestEigenvalue, (uint32_t seed)) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return float(random() % 65536) / 65536; };
  const float flatness = *rc::gen::element(1.0f, 0.1f, 0.001f, 0.0f);
  const float scale = *rc::gen::element(1.0f, 1e-3f, 1e3f);
  FaceQuadric q;
  std::vector<Eigen::Vector3d> points;
  for (int t = 0; t < 20; ++t) {
    vec3 p[3];
    for (vec3& v : p) {
      v = scale * vec3(uniform(), uniform(), flatness * uniform());
      points.push_back({double(v.x), double(v.y), double(v.z)});
    }
    const FaceQuadric next = FaceQuadric::of_triangle(p[0], p[1], p[2]);
    q = t == 0 ? next : merged(q, next);
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p / double(points.size());
  Eigen::Matrix3d z = Eigen::Matrix3d::Zero();
  for (const auto& p : points) z += (p - mean) * (p - mean).transpose() / double(points.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(z, Eigen::EigenvaluesOnly);
  const double expected = solver.eigenvalues()(0), largest = solver.eigenvalues()(2);
  // To half a percent where it is large, and to single precision of the extent where it is small.
  RC_ASSERT(std::abs(double(fit_error(q)) - expected) <= 5e-3 * expected + 3e-7 * largest);
}

TEST(MergeCost, HasTheUnitOfAnAreaAndBoundsFromBelow) {
  const auto shape = [](float scale, const vec3& a, const vec3& b, const vec3& c) {
    return shape_of_triangle(scale * a, scale * b, scale * c);
  };
  for (const float scale : {1.0f, 4.0f}) {
    const ClusterShape a = shape(scale, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const ClusterShape b = shape(scale, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0});
    const float shared = scale * std::sqrt(2.0f), cost = merge_cost(a, b, shared, 0.001f);
    EXPECT_LT(least_merge_cost(a, b, shared, 0.001f), cost);
    const ClusterShape a1 = shape(1, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const ClusterShape b1 = shape(1, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0});
    EXPECT_FLOAT_EQ(cost, scale * scale * merge_cost(a1, b1, std::sqrt(2.0f), 0.001f));
  }
}

RC_GTEST_PROP(CostTournament, FindsTheFirstOfTheLeast, (uint32_t seed)) {
  std::mt19937 random(seed);
  std::vector<float> costs(*rc::gen::inRange<size_t>(1, 200));
  CostTournament tournament;
  tournament.reset(costs.size());
  for (uint32_t i = 0; i < costs.size(); ++i) tournament.prepare(i, costs[i] = float(random() % 20));
  tournament.build();
  for (int step = 0; step < 200; ++step) {
    RC_ASSERT(ptrdiff_t(tournament.least()) == std::min_element(costs.begin(), costs.end()) - costs.begin());
    const uint32_t i = uint32_t(random() % costs.size());
    tournament.set(i, costs[i] = random() % 5 == 0 ? CostTournament::kOut : float(random() % 20));
  }
}

}  // namespace
}  // namespace goldthread
