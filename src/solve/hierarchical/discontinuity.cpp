#include "solve/hierarchical/discontinuity.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "base/parallel.h"
#include "base/rng.h"
#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

// A cut leaves on either side a strip at least this wide, as a share of the piece's radius: thinner ones wait
// until the piece is smaller.
constexpr float kThinnest = 0.005f;
// How much of a cut something has to stand along; and how much if the cut is to come before those along
// shadows.
constexpr float kAlong = 0.25f, kMostly = 0.5f;
// And how much of it, without a gap, where there may be another room on the far side.
constexpr float kParts = 0.5f;
// What is larger than this for the scene may be a wall.
constexpr float kWall = 0.15f;
// Of a piece whose radius is at least half a wall a room may take but a corner: there, walls along all lines
// count, if they are this long for the radius.
constexpr float kPartsInAll = 0.25f;
// Lines this near, as a share of the radius, are one.
constexpr float kSameLine = 1e-3f;
// What hovers no higher than this, as a share of the radius, stands on the piece: little light gets under it.
constexpr float kHovers = 0.05f;
// What is turned no farther from the piece than this, as a cosine, lies above it rather than stands on it.
constexpr float kLies = 0.9f;
// What shines and is smaller than this for its distance casts shadows that have an edge.
constexpr float kSmall = 0.1f;
// Places from which a lamp is looked for.
constexpr uint32_t kLooks = 32;
// A shadow's edge is worth a cut if it explains so much of who sees the lamp: less where one side of it is
// all lit or all dark, as beside any edge of a convex shadow.
constexpr float kExplains = 0.5f, kPartsClean = 0.1f;

// Clusters of no more triangles than this are looked through for feet.
constexpr uint32_t kFewTriangles = 64;

// A line in a piece's plane: dot(normal, q) = offset, and how much of the part within the piece something
// stands along, with or without a gap beneath.
struct Line {
  vec2 normal{0};
  float offset = 0;
  float covered = 0, closed = 0, walled = 0, length = 0;
};

// A triangle or patch in its own plane.
struct Piece {
  ElementPolygon polygon;
  vec3 origin, normal, u, v;
  float radius = 0;
  std::array<vec2, kMaxPolygon> corners;

  explicit Piece(const ElementPolygon& outline) : polygon(outline) {
    vec3 sum(0);
    origin = vec3(0);
    for (size_t i = 0; i < polygon.count; ++i) {
      origin += polygon.corners[i] / static_cast<float>(polygon.count);
      if (i >= 2) sum += area_vector(polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]);
    }
    normal = normalize_or(sum, vec3(0, 1, 0));
    u = normalize(std::abs(normal.x) > 0.6f ? vec3(normal.y, -normal.x, 0) : vec3(0, normal.z, -normal.y));
    v = cross(normal, u);
    for (size_t i = 0; i < polygon.count; ++i) {
      corners[i] = flat(polygon.corners[i]);
      radius = std::max(radius, length(corners[i]));
    }
  }

  vec2 flat(const vec3& p) const { return {dot(p - origin, u), dot(p - origin, v)}; }

  CutPlane plane(const Line& line, Seam seam) const {
    const vec3 n = line.normal.x * u + line.normal.y * v;
    return {n, line.offset + dot(n, origin), seam};
  }

  // Where the line enters and leaves, along its direction (-normal.y, normal.x); none where it leaves less
  // than a strip on one side.
  std::optional<vec2> chord(const Line& line) const {
    float low = 0, high = 0, from = std::numeric_limits<float>::max(), to = -from;
    const vec2 along(-line.normal.y, line.normal.x);
    for (size_t i = 0; i < polygon.count; ++i) {
      const vec2 &a = corners[i], &b = corners[(i + 1) % polygon.count];
      const float da = glm::dot(line.normal, a) - line.offset, db = glm::dot(line.normal, b) - line.offset;
      low = std::min(low, da);
      high = std::max(high, da);
      if ((da < 0) == (db < 0)) continue;
      const float t = glm::dot(along, a + da / (da - db) * (b - a));
      from = std::min(from, t);
      to = std::max(to, t);
    }
    if (-low < kThinnest * radius || high < kThinnest * radius || !(from < to)) return {};
    return vec2(from, to);
  }
};

// The part of a triangle that lies in the piece's plane; none where it is a point, or all of it.
bool meets_plane(const std::array<vec3, 3>& corners, const std::array<float, 3>& heights, vec3& from,
                 vec3& to) {
  size_t count = 0;
  std::array<vec3, 3> found{};
  for (size_t k = 0; k < 3; ++k) {
    const size_t next = (k + 1) % 3;
    if (heights[k] == 0) found[count++] = corners[k];
    if (heights[k] * heights[next] < 0)
      found[count++] = corners[k] + heights[k] / (heights[k] - heights[next]) * (corners[next] - corners[k]);
  }
  from = found[0];
  to = found[1];
  return count == 2;
}

// A stretch of a line in a piece's plane.
struct Stretch {
  vec2 from{0}, to{0};
};

// Lines along which something stands on the piece, passes through it or ends above it. What is within `slack`
// metres of the plane is in it; what is within `epsilon` leaves no gap.
class FootLines {
 public:
  FootLines(const Piece& piece, bool both_sides, float slack, float epsilon)
      : piece_(piece), both_sides_(both_sides), slack_(slack), epsilon_(epsilon) {}

  // A triangle that may stand or pass through. What of it passes through leaves no gap, though it may end
  // close behind the plane, and says where the line is.
  void add_standing(const std::array<vec3, 3>& corners, bool large) {
    const std::optional<Stretch> closed = meeting(corners, epsilon_), near = meeting(corners, slack_);
    if (closed || near) add(closed, near ? *near : *closed, large);
  }

  // An edge with nothing beyond it of what lies above the piece within the slack.
  void add_end(const vec3& from, const vec3& to) {
    add(std::nullopt, {piece_.flat(from), piece_.flat(to)}, false);
  }

  // Whether a triangle lies above the piece, nowhere farther from it than the slack, and not on it.
  bool covers(const std::array<vec3, 3>& corners) const {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (const vec3& corner : corners) {
      const float height = dot(corner - piece_.origin, piece_.normal);
      low = std::min(low, height);
      high = std::max(high, height);
    }
    const float most = both_sides_ ? std::max(high, -low) : high;
    return most > epsilon_ && std::max(high, -low) <= slack_ && lies(corners);
  }
  // Whether a triangle is as good as parallel to the piece.
  bool lies(const std::array<vec3, 3>& corners) const {
    const vec3 n = normalize_or(area_vector(corners[0], corners[1], corners[2]), vec3(0));
    return std::abs(dot(n, piece_.normal)) > kLies;
  }

  std::optional<Line> best() const {
    const Line* best = nullptr;
    for (const Line& line : lines_)
      if (line.covered >= kAlong * line.length && (best == nullptr || line.covered > best->covered))
        best = &line;
    return best != nullptr ? std::optional(*best) : std::nullopt;
  }

  // Metres along which walls stand without a gap.
  float walled() const {
    float sum = 0;
    for (const Line& line : lines_) sum += line.walled;
    return sum;
  }

 private:
  // Where a triangle meets the plane, with corners no farther from it than `slack` taken for on it.
  std::optional<Stretch> meeting(const std::array<vec3, 3>& corners, float slack) const {
    std::array<float, 3> heights;
    for (size_t k = 0; k < 3; ++k) {
      heights[k] = dot(corners[k] - piece_.origin, piece_.normal);
      if (std::abs(heights[k]) <= slack) heights[k] = 0;
    }
    vec3 from, to;
    if ((*std::max_element(heights.begin(), heights.end()) <= 0 && !both_sides_) ||
        !meets_plane(corners, heights, from, to))
      return std::nullopt;
    return Stretch{piece_.flat(from), piece_.flat(to)};
  }

  // Where a stretch begins and ends along a direction.
  static vec2 extent(const vec2& along, const Stretch& stretch) {
    const float a = glm::dot(along, stretch.from), b = glm::dot(along, stretch.to);
    return {std::min(a, b), std::max(a, b)};
  }

  // `near` is as long as `closed` or longer; the line is that of `closed`, if there is one.
  void add(const std::optional<Stretch>& closed, const Stretch& near, bool large) {
    const Stretch& exact = closed ? *closed : near;
    const float span = length(exact.to - exact.from);
    if (!(span > kSameLine * piece_.radius)) return;
    const vec2 along = (exact.to - exact.from) / span;
    Line line;
    line.normal = {along.y, -along.x};
    line.offset = glm::dot(line.normal, exact.from);
    const std::optional<vec2> chord = piece_.chord(line);
    if (!chord) return;
    line.length = chord->y - chord->x;
    const vec2 shut = extent(along, exact), all = extent(along, near);
    const auto inside = [&](float from, float to) {
      return std::max(0.0f, std::min(chord->y, to) - std::max(chord->x, from));
    };
    line.covered = inside(std::min(shut.x, all.x), std::max(shut.y, all.y));
    if (line.covered <= kSameLine * piece_.radius) return;
    line.closed = closed ? inside(shut.x, shut.y) : 0.0f;
    line.walled = large ? line.closed : 0;
    join(line);
  }

  void join(const Line& line) {
    for (Line& other : lines_) {
      const float same = glm::dot(other.normal, line.normal) < 0 ? -1.0f : 1.0f;
      if (length(other.normal - same * line.normal) > kSameLine ||
          std::abs(other.offset - same * line.offset) > kSameLine * piece_.radius)
        continue;
      other.covered += line.covered;
      other.closed += line.closed;
      other.walled += line.walled;
      return;
    }
    lines_.push_back(line);
  }

  const Piece& piece_;
  const bool both_sides_;
  const float slack_, epsilon_;
  std::vector<Line> lines_;
};

std::array<vec3, 3> corners_of(const Part& part, const TriangleMesh& mesh, uint32_t triangle) {
  const UVec3& c = mesh.triangles[triangle];
  return {part.positions[c.x], part.positions[c.y], part.positions[c.z]};
}

std::array<vec3, 3> corners_of(const SurfaceSet& set, uint32_t triangle) {
  const Part& part = part_of_triangle(set, triangle);
  return corners_of(part, set.tree(part).mesh, triangle - part.first_triangle);
}

// Where something stands on a piece.
struct FoundFoot {
  CutPlane cut;
  bool is_long = false, parts = false;
};

// The ends of what lies above the piece: edges of a triangle there without a neighbour that lies there, too.
void add_ends(const SurfaceSet& set, const FeetWorld& world, uint32_t triangle, FootLines& feet) {
  const Part& part = part_of_triangle(set, triangle);
  const TriangleMesh& mesh = set.tree(part).mesh;
  const std::vector<uint32_t>& twins = world.twins[part.tree];
  const uint32_t t = triangle - part.first_triangle;
  const std::array<vec3, 3> corners = corners_of(part, mesh, t);
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t twin = twins[3 * size_t{t} + k];
    if (twin == kNoTwin || !feet.lies(corners_of(part, mesh, twin / 3)))
      feet.add_end(corners[k], corners[(k + 1) % 3]);
  }
}

FoundFoot find_foot(const ElementPool& pool, const Visibility& visibility, const FeetWorld& world,
                    const Piece& piece, ElementId id) {
  const SurfaceSet& set = pool.surfaces();
  const bool both = set.scene->materials[set.parts[pool[id].part].material].lit_behind();
  const float slack = std::max(visibility.epsilon, kHovers * piece.radius);
  FootLines feet(piece, both, slack, visibility.epsilon);
  Box box;
  for (const vec3& p : piece.polygon.span()) box.add(p);
  const float wall = kWall * visibility.extent;
  visibility.caster->visit_near(box, piece.normal, dot(piece.normal, piece.origin), slack, [&](uint32_t t) {
    const std::array<vec3, 3> corners = corners_of(set, t);
    // Ends of dark plates, of rugs and pictures, would be worth a cut as well; yet with those, cuts in
    // small-house are such that its links lose a third more of the light.
    if (feet.covers(corners) && set.scene->materials[part_of_triangle(set, t).material].emits()) {
      add_ends(set, world, t, feet);
    } else {
      feet.add_standing(corners, world.sizes[t] >= wall);
    }
  });
  const std::optional<Line> foot = feet.best();
  FoundFoot found;
  found.parts = piece.radius >= 0.5f * wall && feet.walled() >= kPartsInAll * piece.radius;
  if (!foot) return found;
  found.cut = piece.plane(*foot, foot->closed < 0.5f * foot->covered ? Seam::kGap : Seam::kSharp);
  found.is_long = foot->covered >= kMostly * foot->length;
  found.parts |= foot->walled >= kParts * foot->length;
  return found;
}

// The way from a place to the middle of a lamp; 0 where the lamp does not shine there.
vec3 way_to(const ElementPool& pool, ElementId lamp, const vec3& x, float far) {
  const Element& e = pool[lamp];
  if (e.kind == ElementKind::kSun) return -far * pool.light(lamp).direction;
  const vec3 way = e.centre - x;
  if (is_surface(e.kind) && dot(way, e.summed_normal) >= 0) return vec3(0);
  if (e.kind == ElementKind::kPoint && pool.light(lamp).has_area() &&
      dot(way, pool.light(lamp).direction) >= 0)
    return vec3(0);
  return way;
}

// Metres from a lamp's middle to what is farthest of it; of a sun radians, as if it were a metre away.
float reach_of(const ElementPool& pool, ElementId lamp) {
  const Element& e = pool[lamp];
  if (is_surface(e.kind)) return e.radius;
  const Light& light = pool.light(lamp);
  if (e.kind == ElementKind::kSun) return 0.5f * light.angular_diameter;
  return light.has_area() ? light.reach() : light.radius;
}

// Places of the piece, and whether they see the lamp.
struct Looks {
  std::array<vec2, kLooks> places;
  std::array<bool, kLooks> lit;
  uint32_t count = 0, lit_count = 0;
  std::vector<uint32_t> blockers;  // triangles that stand between
};

Looks look_for(const ElementPool& pool, const Visibility& visibility, const Piece& piece, ElementId id,
               ElementId lamp, RayCount& rays) {
  Looks looks;
  const uint32_t pattern = hash(hash(id, lamp), visibility.seed);
  for (uint32_t i = 0; i < kLooks; ++i) {
    const UnitSquarePoint at = r2_point(i, pattern);
    const vec3 x = pool.sample_at(id, at.u, at.v).position;
    const vec3 way = way_to(pool, lamp, x, 2 * visibility.extent);
    if (dot(way, piece.normal) <= 0) continue;
    const float far = is_surface(pool[lamp].kind) ? 0.999f : 1.0f;
    const Hit hit = visibility.caster->closest(Ray{x + visibility.epsilon * piece.normal, way, 0, far});
    ++rays.rays;
    looks.places[looks.count] = piece.flat(x);
    looks.lit[looks.count++] = hit.missed();
    if (hit.missed()) {
      ++looks.lit_count;
    } else {
      looks.blockers.push_back(hit.triangle);
    }
  }
  std::sort(looks.blockers.begin(), looks.blockers.end());
  looks.blockers.erase(std::unique(looks.blockers.begin(), looks.blockers.end()), looks.blockers.end());
  return looks;
}

// What of the variance of who sees the lamp is one between the sides of a line; 0 where that is not enough.
float explained(const Looks& looks, const Line& line) {
  float count = 0, lit = 0;
  for (uint32_t i = 0; i < looks.count; ++i) {
    if (glm::dot(line.normal, looks.places[i]) < line.offset) continue;
    count += 1;
    lit += looks.lit[i] ? 1.0f : 0.0f;
  }
  const auto all = static_cast<float>(looks.count), all_lit = static_cast<float>(looks.lit_count);
  const float rest = all - count, rest_lit = all_lit - lit;
  if (count == 0 || rest == 0) return 0;
  const auto squares = [](float n, float seen) { return seen * (n - seen) / n; };
  const float share = 1 - (squares(count, lit) + squares(rest, rest_lit)) / squares(all, all_lit);
  const bool clean = lit == 0 || lit == count || rest_lit == 0 || rest_lit == rest;
  return share >= (clean ? kPartsClean : kExplains) ? share : 0;
}

std::optional<Line> find_shadow_edge(const ElementPool& pool, const Visibility& visibility,
                                     const Piece& piece, ElementId id, ElementId lamp, RayCount& rays) {
  const Looks looks = look_for(pool, visibility, piece, id, lamp, rays);
  if (looks.lit_count == 0 || looks.lit_count == looks.count) return {};
  const SurfaceSet& set = pool.surfaces();
  std::optional<Line> best;
  float most = 0;
  for (const uint32_t t : looks.blockers) {
    const std::array<vec3, 3> corners = corners_of(set, t);
    for (size_t k = 0; k < 3; ++k) {
      const vec3 &a = corners[k], &b = corners[(k + 1) % 3];
      // Shadows of the edge end where the plane through it and the lamp meets the piece.
      const vec3 n = normalize_or(cross(b - a, way_to(pool, lamp, a, 1)), vec3(0));
      const vec2 flat(dot(n, piece.u), dot(n, piece.v));
      const float slope = length(flat);
      if (!(slope > 1e-4f)) continue;
      Line line;
      line.normal = flat / slope;
      line.offset = dot(n, a - piece.origin) / slope;
      const float share = explained(looks, line);
      if (share <= most || !piece.chord(line)) continue;
      most = share;
      best = line;
    }
  }
  return best;
}

bool is_polygon(ElementKind kind) {
  return kind == ElementKind::kTriangle || kind == ElementKind::kPatch;
}

CutPlane find_discontinuity(const ElementPool& pool, const Visibility& visibility, ElementId id,
                            const Feet& feet, const LampLinks& lamps, RayCount& rays) {
  if (!is_polygon(pool[id].kind)) return {};
  if (feet.is_long(id)) return feet.of(id);
  const Piece piece(pool.polygon(id));
  for (const ElementId lamp : lamps.lamps_of(id))
    if (const std::optional<Line> edge = find_shadow_edge(pool, visibility, piece, id, lamp, rays))
      return piece.plane(*edge, reach_of(pool, lamp) > 0 ? Seam::kNone : Seam::kSharp);
  return feet.of(id);
}

bool casts_edges(const ElementPool& pool, const Link& link) {
  if (link.visibility == 0 || link.visibility == 255) return false;
  const Element &r = pool[link.receiver], &s = pool[link.source];
  if (s.kind == ElementKind::kSky || s.kind == ElementKind::kVolume || !(largest(s.exitance) > 0))
    return false;
  const float distance = s.kind == ElementKind::kSun ? 1.0f : length(s.centre - r.centre);
  return reach_of(pool, link.source) < kSmall * distance;
}

}  // namespace

LampLinks::LampLinks(const ElementPool& pool, const RadiosityState& state, std::span<const Link> links)
    : pool_(pool) {
  for (const Link& link : links)
    if (link.alive && casts_edges(pool, link))
      links_.push_back({link.receiver, link.source, link.unoccluded * largest(state.shown[link.source])});
  std::sort(links_.begin(), links_.end(), [](const Entry& a, const Entry& b) {
    return a.receiver < b.receiver || (a.receiver == b.receiver && a.lamp < b.lamp);
  });
}

std::vector<ElementId> LampLinks::lamps_of(ElementId id) const {
  std::vector<Entry> found;
  for (; id != kNoElement; id = pool_[id].parent) {
    const auto first = std::lower_bound(links_.begin(), links_.end(), id,
                                        [](const Entry& e, ElementId r) { return e.receiver < r; });
    for (auto at = first; at != links_.end() && at->receiver == id; ++at) found.push_back(*at);
  }
  std::sort(found.begin(), found.end(), [](const Entry& a, const Entry& b) {
    return a.strength > b.strength || (a.strength == b.strength && a.lamp < b.lamp);
  });
  std::vector<ElementId> lamps;
  lamps.reserve(found.size());
  for (const Entry& entry : found) lamps.push_back(entry.lamp);
  return lamps;
}

namespace {

FeetWorld world_of(const SurfaceSet& set) {
  FeetWorld world;
  world.sizes.resize(set.triangles, 0);
  for (const Surface& surface : set.surfaces) {
    const TriangleRange range = triangles_of(set, surface);
    const float size = box_of(set, surface).diagonal();
    const uint32_t first = set.parts[surface.part].first_triangle + range.first;
    std::fill_n(world.sizes.begin() + first, range.count, size);
  }
  world.twins.resize(set.trees.size());
  parallel_for(set.trees.size(), [&](size_t i) { world.twins[i] = find_twins(set.trees[i].mesh); });
  return world;
}

// The foot of an element; of a cluster whether any of its triangles has one that parts it.
FoundFoot find_foot(const ElementPool& pool, const Visibility& visibility, const FeetWorld& world,
                    ElementId id) {
  const Element& e = pool[id];
  const auto look = [&](const ElementPolygon& polygon) {
    return find_foot(pool, visibility, world, Piece(polygon), id);
  };
  if (is_polygon(e.kind)) return look(pool.polygon(id));
  FoundFoot found;
  if (e.kind != ElementKind::kCluster) return found;
  const SurfaceSet& set = pool.surfaces();
  const FaceCluster& node = set.tree(set.parts[e.part]).nodes[e.shape];
  if (node.count <= kFewTriangles)
    for (uint32_t t = node.first; t < node.first + node.count && !found.parts; ++t)
      found.parts = look(pool.polygon(id, t)).parts;
  return found;
}

}  // namespace

void Feet::grow_to(const ElementPool& pool, const Visibility& visibility) {
  const size_t first = known_;
  known_ = pool.size();
  if (!visibility.discontinuities) return;
  if (world_.sizes.empty()) world_ = world_of(pool.surfaces());
  std::vector<FoundFoot> found(known_ - first);
  parallel_for(
      found.size(),
      [&](size_t i) { found[i] = find_foot(pool, visibility, world_, static_cast<ElementId>(first + i)); },
      64);
  for (size_t i = 0; i < found.size(); ++i) {
    const auto id = static_cast<ElementId>(first + i);
    if (found[i].cut.present()) cuts_.emplace(id, found[i].cut);
    if (found[i].is_long) long_.insert(id);
    if (found[i].parts) parted_.insert(id);
  }
}

CutPlane Feet::of(ElementId id) const {
  const auto found = cuts_.find(id);
  return found != cuts_.end() ? found->second : CutPlane();
}

std::vector<CutPlane> find_discontinuities(const ElementPool& pool, const Visibility& visibility,
                                           std::span<const ElementId> ids, const Feet& feet,
                                           const LampLinks& lamps, RayCount& rays) {
  std::vector<CutPlane> cuts(ids.size());
  if (!visibility.discontinuities) return cuts;
  std::atomic<uint64_t> cast{0};
  parallel_for(
      ids.size(),
      [&](size_t i) {
        RayCount count;
        cuts[i] = find_discontinuity(pool, visibility, ids[i], feet, lamps, count);
        cast.fetch_add(count.rays, std::memory_order_relaxed);
      },
      8);
  rays.rays += cast.load();
  return cuts;
}

}  // namespace goldthread
