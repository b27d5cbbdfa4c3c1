// Light at all light points, and the mesh cut where what lies between them is not what they say.
#pragma once
#include <array>
#include <vector>

#include "reconstruct/final_gather.h"
#include "reconstruct/leaf_faces.h"
#include "reconstruct/light_points.h"
#include "reconstruct/reconstruct.h"

namespace goldthread {

/// Gathers light at the corners of the leaf mesh, then at places within the faces, and compares: where light
/// bends between the corners (a shadow's edge, a contact), the leaf is cut and its new corners are gathered,
/// until what the faces are still wrong by amounts to no more than the tolerance. Links say how light
/// travels, and a few elements do for that; how many it takes to show it, only the shown light can tell.
class AdaptiveGather {
 public:
  /// All are borrowed. Elements are added to the solver's, links are not.
  AdaptiveGather(HierarchicalSolver& solver, const ReconstructOptions& options, const CancelToken& cancel,
                 ReconstructStats& stats);

  /// When cancelled, what is not yet gathered is the mean of the leaves around it.
  void run();

  /// Sets ReconstructStats::estimate from so many places, spread by area, at which light is gathered with
  /// more rays than the light points had.
  void measure_error(uint32_t places);

  bool is_lit(uint32_t part) const { return !parts_[part].sides.empty(); }
  const PartPoints& points(uint32_t part) const { return parts_[part].points; }
  /// Lux by light point; the back's of two-sided parts.
  const std::vector<vec3>& light(uint32_t part, bool back) const {
    return parts_[part].sides[back ? 1 : 0].light;
  }
  /// What elements show, leaves as their corners have it.
  ShownLight shown_light() const;
  bool is_two_sided(uint32_t part) const { return parts_[part].sides.size() > 1; }

 private:
  // What has been gathered at a vertex, for each normal there.
  struct Kept {
    vec3 normal{0}, light{0}, place{0};
    float variance = 0;
    float reach = 0;  // metres to the middle of the face it was drawn into
    bool buried = false;
    ElementId near_leaf = kNoElement;
    uint32_t next = kNone;
  };
  struct Side {
    std::vector<ElementId> leaves;     // by face
    std::vector<vec3> light;           // by point
    std::vector<float> variance;       // by point
    std::vector<uint8_t> buried;       // by point
    std::vector<uint32_t> first_kept;  // by vertex
    std::vector<Kept> kept;
  };
  struct PartLight {
    PartPoints points;
    std::vector<Side> sides;
    bool changed = true;
  };
  struct Job {
    uint32_t part = 0, side = 0, point = 0;
    uint32_t kept = kNone;  // to be overwritten
  };
  // What is wrong in a leaf, and how much light it gets.
  struct LeafError {
    double area = 0, square = 0;    // m^2, lux^2: mean over the tests
    vec3 light{0};                  // lux, mean
    uint32_t tests = 0, looks = 0;  // places, and how often places were chosen
    double counted = 0;             // lux^2 m^2, by regard and by what can be seen of it, when last weighed
    double squares() const { return area * square; }
    void add(const LeafError& more);
  };
  struct Test {
    uint32_t part = 0, side = 0, first_face = 0, faces = 0;  // in leaf_faces_
    ElementId leaf = kNoElement;
  };
  struct TestPlace {
    vec3 position{0}, normal{0};
    vec3 said{0};      // lux, by the corners
    float doubt = 0;   // variance of its luminance
    float cosine = 1;  // between the normal and the face's
  };
  static constexpr uint32_t kNone = 0xffffffffu;

  void collect(uint32_t part);
  void update_points();
  bool is_hidden(const Gathered& gathered, const vec3& x, const vec3& n, RayCount& count) const;
  void gather(const std::vector<Job>& jobs);
  void fill_buried(const PartPoints& points, std::vector<uint8_t> buried, std::vector<vec3>& light) const;
  std::vector<Test> list_tests(bool again);
  LeafFaces faces_of(const Test& test) const;
  TestPlace test_place(const Test& test, const FacePlace& at) const;
  uint32_t places_to_test(const Test& test, const LeafFaces& faces, double unit_areas) const;
  LeafError test(const Test& test, double unit_area, RayCount& count) const;
  void test_leaves(bool again);
  uint64_t gathers() const { return stats_.points + stats_.places; }
  bool is_spent() const {
    if (options_.full && options_.full()) return true;
    return static_cast<double>(gathers()) > options_.growth * static_cast<double>(first_gathers_);
  }
  bool cut();
  void cut_now(std::vector<ElementId> leaves);
  std::vector<ElementId> nearly_whole(std::span<const ElementId> parents) const;
  std::vector<std::pair<uint32_t, uint32_t>> spread_places(const std::vector<Test>& tests,
                                                           uint32_t places) const;
  void show_leaves();

  HierarchicalSolver& solver_;
  const ReconstructOptions& options_;
  const CancelToken& cancel_;
  ReconstructStats& stats_;
  const GatherOptions gather_;
  ShownLight shown_;
  std::vector<PartLight> parts_;
  std::vector<uint32_t> leaf_faces_;  // faces of the leaves being tested
  std::vector<LeafError> errors_;     // by element; area 0: not tested
  double mean_light_ = 1;             // lux, by area that counts
  double at_stake_ = 0;               // lux^2 m^2: error found that cuts might mend, or what is allowed
  size_t solved_elements_ = 0;        // those that the solver knows
  uint64_t first_gathers_ = 0;
  std::vector<uint8_t> cut_;  // by element: the solver's leaves that were cut here
};

}  // namespace goldthread
