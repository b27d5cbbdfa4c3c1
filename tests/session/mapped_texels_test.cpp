// What a texel of a solution's light map stands for: the places at which its light is measured.
#include "session/mapped_texels.h"

#include <gmock/gmock.h>

#include <cmath>

#include "files/solution_file.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;

class MappedTexelsOfABox : public ::testing::Test {
 protected:
  MappedTexelsOfABox() {
    BakeOptions options = draft(made(folder_, "cornell-box"), {folder_.path("a.gold")});
    options.mode = OutputMode::kLightmap;
    options.lightmap.page_size = 64;
    baked(options);
    Result<Solution> read = read_solution(options.outputs[0]);
    if (!read) throw std::runtime_error(read.error().line());
    solution_ = *std::move(read);
    scene_ = std::make_unique<TracedScene>(solution_.scene);
  }

  MappedTexels texels(uint64_t count, uint32_t seed = 0) const {
    return mapped_texels(*scene_, *solution_.atlas, count, seed);
  }
  /// Metres.
  double texel_side() const { return 1 / static_cast<double>(solution_.atlas->texels_per_metre); }

  TempFolder folder_;
  Solution solution_;
  std::unique_ptr<TracedScene> scene_;
};

TEST_F(MappedTexelsOfABox, AWholeTexelIsMeasuredAllOverItsSquare) {
  const MappedTexels found = texels(1'000'000);
  ASSERT_EQ(found.first.size(), found.centres.size() + 1);
  ASSERT_EQ(found.first.back(), found.places.size());
  size_t whole = 0;
  for (size_t i = 0; i < found.centres.size(); ++i) {
    const size_t first = found.first[i], end = found.first[i + 1];
    ASSERT_GE(end, first + 1);
    ASSERT_LE(end, first + kPlacesInTexel);
    dvec3 mean(0);
    double squares = 0;
    bool flat = true;  // all in one triangle, of which a texel's part is a linear image
    for (size_t p = first; p < end; ++p) {
      const dvec3 off = dvec3(found.places[p].point) - dvec3(found.centres[i].point);
      // Charts here are not stretched: no place is further than a half diagonal from the middle.
      EXPECT_LE(glm::length(off), 0.71 * texel_side() * 1.001);
      flat = flat && found.places[p].triangle == found.centres[i].triangle;
      mean += off / static_cast<double>(end - first);
      squares += glm::dot(off, off) / static_cast<double>(end - first);
    }
    if (end - first != kPlacesInTexel || !flat) continue;
    ++whole;
    EXPECT_LT(glm::length(mean), 1e-4 * texel_side());
    // Of a square of side s the mean square distance is s^2 / 6; of a grid of n by n places a share 1 / n^2
    // less.
    EXPECT_NEAR(squares, texel_side() * texel_side() / 6 * (1 - 1.0 / kPlacesInTexel),
                1e-3 * texel_side() * texel_side());
  }
  EXPECT_GT(whole, found.centres.size() / 2);
}

TEST_F(MappedTexelsOfABox, AFewAreSomeOfAllAndAnotherSeedChoosesOthers) {
  const MappedTexels all = texels(1'000'000), some = texels(100), others = texels(100, 1);
  ASSERT_EQ(some.centres.size(), 100u);
  const auto same = [](const Receiver& a, const Receiver& b) {
    return a.triangle == b.triangle && a.weights == b.weights && a.back == b.back;
  };
  size_t at = 0, shared = 0;
  for (const Receiver& chosen : some.centres) {
    while (at < all.centres.size() && !same(all.centres[at], chosen)) ++at;
    ASSERT_LT(at, all.centres.size()) << "not one of all, or not in their order";
    ++at;
  }
  for (const Receiver& a : some.centres)
    for (const Receiver& b : others.centres) shared += same(a, b);
  EXPECT_LT(shared, 50u);
}

}  // namespace
}  // namespace goldthread
