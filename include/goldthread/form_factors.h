// Form factors (view factors) of pairs of shapes and of whole models.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "goldthread/bake.h"
#include "goldthread/error.h"

namespace goldthread {

struct FormFactorOptions {
  enum class Method {
    kAuto,      ///< exact for models of up to 100 polygons, else rays
    kExact,     ///< contour integrals; past occluders, the exact visible part integrated to the tolerance
    kRays,      ///< closed forms for what is unoccluded, rays for the share that is seen
    kHemicube,  ///< classical item buffers at each polygon's points
    kCubicTetrahedron,  ///< the same on three faces in the place of five
    kSinglePlane,       ///< the same on one plane, which misses the horizon
  };
  std::string input;  ///< .json or .vs3
  std::string only;   ///< this case alone; empty for all
  Method method =
      Method::kAuto;  ///< of models; pairs are exact, but for curved shapes past occluders: by rays
  /// Relative, past occluders: 1e-5 for pairs, 1e-4 in models and of two standard errors where rays are cast
  /// for a pair; these are sixteen million at most.
  std::optional<double> tolerance;
  uint32_t rays = 16;           ///< a pair, with kRays
  uint32_t resolution = 64;     ///< cells along an item buffer
  uint32_t samples_across = 2;  ///< of each cell: 1 through its middle, k for k x k against aliasing
  uint64_t seed = 0;
  int threads = 0;                     ///< 0: all
  std::optional<uint64_t> max_memory;  ///< bytes for a matrix
  bool enforce_reciprocity = false;    ///< item buffers: the mean of both directions; others keep it anyway
  bool enforce_closure = false;        ///< scale until rows and their surroundings sum to one
  std::string json_file, npz_file, text_file;  ///< results; empty for none
};

struct FormFactorResult {
  std::string text;  ///< for a person: pairs, or small matrices, row sums and what they are off
  std::vector<std::string> warnings;
  std::vector<std::string> written;  ///< files
};

/// Reads, computes, writes. All values lie in 0..1, each with a bound of its error and the method that found
/// it; a pair's by rays also with its standard error, of which the bound is two. `listener.cancelled` ends it
/// with ErrorCode::kCancelled and nothing written.
Result<FormFactorResult> form_factors(const FormFactorOptions& options, const BakeListener& listener = {});

}  // namespace goldthread
