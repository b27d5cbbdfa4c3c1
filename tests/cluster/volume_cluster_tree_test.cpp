#include "cluster/volume_cluster_tree.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <random>

namespace goldthread {
namespace {

std::vector<Box> random_items(uint32_t seed, size_t count) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return float(random() % 10000) / 10000; };
  std::vector<Box> items(count);
  for (Box& item : items) {
    const vec3 low(uniform(), uniform(), uniform());
    item.add(low);
    item.add(low + 0.1f * vec3(uniform(), uniform(), uniform()));
  }
  return items;
}

VolumeClusterTree build(const std::vector<Box>& items) {
  VolumeClusterTree tree = build_volume_clusters(items);
  validate(tree, items);
  return tree;
}

Box item_at(const vec3& p, float size) {
  Box item;
  item.add(p - 0.5f * size);
  item.add(p + 0.5f * size);
  return item;
}

TEST(VolumeClusterTree, NoneOneAndTwo) {
  EXPECT_TRUE(build({}).nodes.empty());
  EXPECT_TRUE(build(random_items(1, 1)).nodes.empty());
  const VolumeClusterTree tree = build(random_items(1, 2));
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_TRUE(tree.nodes[0].child[0] & kItemBit);
}

TEST(VolumeClusterTree, TwoHeapsArePartedFirst) {
  std::vector<Box> items;
  for (int i = 0; i < 5; ++i) items.push_back(item_at(vec3(0.01f * float(i), 0, 0), 0.1f));
  for (int i = 0; i < 3; ++i) items.push_back(item_at(vec3(0, 10 + 0.01f * float(i), 0), 0.1f));
  const VolumeClusterTree tree = build(items);
  EXPECT_LT(tree.nodes[tree.nodes[0].child[0]].box.high.y, 1);
  EXPECT_GT(tree.nodes[tree.nodes[0].child[1]].box.low.y, 9);
}

TEST(VolumeClusterTree, CoincidingItemsAreHalved) {
  const std::vector<Box> items(1024, item_at(vec3(1, 2, 3), 1));
  const VolumeClusterTree tree = build(items);
  uint32_t depth = 0;
  for (uint32_t node = 0; !(node & kItemBit); node = tree.nodes[node].child[1]) ++depth;
  EXPECT_EQ(depth, 10u);
}

TEST(VolumeClusterTree, ABoundedDepthForAGalaxyOfSizes) {
  std::vector<Box> items;
  for (int i = 0; i < 4000; ++i) {
    const float size = std::exp2(float(i) * 0.015f - 30);
    items.push_back(item_at(vec3(size, 0, 0), size));
  }
  const VolumeClusterTree tree = build(items);
  std::vector<uint32_t> depth(tree.nodes.size(), 1);
  for (uint32_t i = 0; i < tree.nodes.size(); ++i)
    for (const VolumeRef child : tree.nodes[i].child)
      if (!(child & kItemBit)) depth[child] = depth[i] + 1;
  EXPECT_LE(*std::max_element(depth.begin(), depth.end()), 64u + 4 * 12);
}

TEST(VolumeClusterTree, TheSameForAnyNumberOfThreads) {
  const std::vector<Box> items = random_items(3, 20000);
  VolumeClusterTree trees[2];
  for (size_t threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    trees[threads - 1] = build(items);
  }
  EXPECT_EQ(std::memcmp(trees[0].nodes.data(), trees[1].nodes.data(),
                        trees[0].nodes.size() * sizeof(VolumeCluster)),
            0);
}

RC_GTEST_PROP(VolumeClusterTree, AnyItemsGiveAValidTree, ()) {
  const auto seed = *rc::gen::arbitrary<uint32_t>();
  const auto count = *rc::gen::inRange<size_t>(0, 300);
  build(random_items(seed, count));
}

}  // namespace
}  // namespace goldthread
