#include "session/solve_session.h"

#include <gtest/gtest.h>

#include <chrono>

#include "session/light_setup.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// Minutes of work, so that a session can be looked at while it runs.
SolveOptions endless() {
  SolveOptions options;
  options.last_error = 1e-8;
  options.least_area = 1e-9;
  return options;
}

/// Waits until `ready()` or a generous time has passed.
template <typename Ready>
bool eventually(const Ready& ready, double seconds = 20) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!ready()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

TEST(SolveSession, RunsToItsEnd) {
  Solved solved(test::procedural("furnace", 1200), test::quick());
  SolveSession session(*solved.solver);
  EXPECT_EQ(session.snapshot(), nullptr);
  session.start();
  ASSERT_TRUE(session.wait(60000));
  EXPECT_DOUBLE_EQ(session.progress().share, 1);
  EXPECT_TRUE(solved.solver->stats().converged);
  const auto picture = session.snapshot();
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->revision, 1u);
  EXPECT_GT(session.progress().rays, 0u);
  EXPECT_GT(session.progress().links, 0u);
  EXPECT_TRUE(session.wait(0));
}

TEST(SolveSession, SnapshotsWhileRunningAndTheirRevisionGrows) {
  Solved solved(test::procedural("two-rooms"), endless());
  SolveSession session(*solved.solver);
  session.start();
  ASSERT_TRUE(eventually([&] { return session.snapshot() != nullptr; }));
  EXPECT_FALSE(session.wait(0));
  const auto first = session.snapshot();
  const size_t values = first->primitives.at(0).irradiance.size();
  for (uint32_t revision = first->revision + 1; revision < first->revision + 4; ++revision) {
    session.request_snapshot();
    ASSERT_TRUE(eventually([&] { return session.snapshot()->revision >= revision; })) << revision;
  }
  // The first is still what it was, whoever holds it.
  EXPECT_EQ(first->primitives.at(0).irradiance.size(), values);
  for (const LitPrimitive& lit : session.snapshot()->primitives)
    for (const vec3& e : lit.irradiance) ASSERT_TRUE(is_finite(e));
}

TEST(SolveSession, PauseStopsTheRaysAndResumeGoesOn) {
  Solved solved(test::procedural("two-rooms"), endless());
  std::atomic<uint64_t> waves{0};
  SolveSession session(*solved.solver);
  session.watch = [&] {
    ++waves;
    return false;
  };
  session.start();
  ASSERT_TRUE(eventually([&] { return session.progress().rays > 1000; }));
  session.pause();
  // Takes effect within a wave: wait until waves no longer come.
  uint64_t before = waves;
  ASSERT_TRUE(eventually([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    return std::exchange(before, waves.load()) == waves.load();
  }));
  const uint64_t rays = session.progress().rays;
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  EXPECT_EQ(session.progress().rays, rays);
  EXPECT_EQ(waves, before);
  session.resume();
  EXPECT_TRUE(eventually([&] { return session.progress().rays > rays; }));
}

TEST(SolveSession, CancelEndsSoonWithASolution) {
  Solved solved(test::procedural("two-rooms"), endless());
  SolveSession session(*solved.solver);
  session.start();
  ASSERT_TRUE(eventually([&] { return session.snapshot() != nullptr; }));
  session.cancel();
  EXPECT_TRUE(session.wait(2000));
  EXPECT_FALSE(solved.solver->stats().converged);
  double light = 0;
  for (const ElementId id : solved.leaves()) {
    ASSERT_TRUE(is_finite(solved.state().irradiance[id]));
    light += double(solved.state().irradiance[id].x);
  }
  EXPECT_GT(light, 0);
}

TEST(SolveSession, CancelWhilePaused) {
  Solved solved(test::procedural("two-rooms"), endless());
  SolveSession session(*solved.solver);
  session.pause();
  session.start();
  EXPECT_FALSE(session.wait(200));
  session.cancel();
  EXPECT_TRUE(session.wait(5000));
}

TEST(SolveSession, WatchCancels) {
  Solved solved(test::procedural("two-rooms"), endless());
  SolveSession session(*solved.solver);
  session.watch = [calls = 0]() mutable { return ++calls > 3; };
  session.start();
  EXPECT_TRUE(session.wait(20000));
  EXPECT_FALSE(solved.solver->stats().converged);
}

TEST(SolveSession, GoesAwayWhileRunning) {
  Solved solved(test::procedural("two-rooms"), endless());
  {
    SolveSession session(*solved.solver);
    session.start();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  SUCCEED();
}

TEST(SolveSession, NeverStarted) {
  Solved solved(test::procedural("furnace"));
  SolveSession session(*solved.solver);
  EXPECT_FALSE(session.wait(0));
}

}  // namespace
}  // namespace goldthread
