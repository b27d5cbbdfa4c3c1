// Cases for `formfactors`: JSON and View3D's .vs3.
#pragma once
#include <string>
#include <string_view>

#include "goldthread/error.h"
#include "scene/polygon_model.h"

namespace goldthread {

/// Reads by extension. JSON holds `cases`, each a pair ("from", "to", "occluders") or a model ("surfaces"
/// with "vertices" and "name", "occluders"), or one such object by itself. Every polygon is checked
/// (polygon_problem), every number finite; what is wrong is named with file, case or line, and record.
Result<FormFactorInput> read_form_factor_cases(const std::string& file);

/// The same of text that has been read already; `file` is only named.
Result<FormFactorInput> parse_form_factor_json(std::string_view text, const std::string& file);

/// View3D's geometry, formats 3 (vertices) and 3a (rectangles and quadrilaterals by origin, azimuth and
/// tilt): records T C F V S M N O, comments behind '!', up to "End". Subsurfaces, combined surfaces, masks
/// (M) and null surfaces (N) are kept as such; the latter two must lie within their base and face it, as
/// View3D has it. An obstruction (O) may be the base of surfaces, which it does not hide. Emittances are not
/// used. Any other record is an error.
Result<FormFactorInput> parse_vs3(std::string_view text, const std::string& file);

}  // namespace goldthread
