#include "trace/scrambled_sobol.h"

#include "base/check.h"
#include "base/wide.h"

namespace goldthread {
namespace {

// Hashes and scramblings are a hundred integer operations a point.
GOLDTHREAD_WIDE_CLONES void sobol_points(const PathSeed* paths, size_t count, uint32_t pair,
                                         SobolPoint* points) {
  for (size_t i = 0; i < count; ++i) points[i] = sobol_point(paths[i].index, hash(paths[i].seed, pair));
}

GOLDTHREAD_WIDE_CLONES void hashed_points(const PathSeed* paths, size_t count, uint32_t pair,
                                          SobolPoint* points) {
  for (size_t i = 0; i < count; ++i) points[i] = hashed_point(paths[i].index, hash(paths[i].seed, pair));
}

}  // namespace

void path_points(std::span<const PathSeed> paths, uint32_t pair, std::span<SobolPoint> points) {
  GOLDTHREAD_CHECK_EQ(paths.size(), points.size());
  const auto draw = pair <= kSobolPairs ? sobol_points : hashed_points;
  draw(paths.data(), paths.size(), pair, points.data());
}

}  // namespace goldthread
