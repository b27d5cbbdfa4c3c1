// Photometric files (IES LM-63).
#pragma once
#include <string>
#include <string_view>

#include "goldthread/error.h"
#include "scene/light_profile.h"

namespace goldthread {

/// LM-63 of 1986, 1991, 1995, 2002 and 2019, photometry of types C and B. Candela are those of the file times
/// its multiplier, its ballast factor and, before 2002, its ballast-lamp factor. With TILT=INCLUDE they are
/// times the factor of no tilt, and the profile says that there are others. The luminous opening, lamps and
/// watts are read past, as is what comes after the last candela value.
///
/// An Error (kBadInput) with the line for anything else: type A, TILT=file, angles that do not ascend, leave
/// their range or have no known symmetry, values that are missing, negative or no numbers.
Result<LightProfile> read_ies(const std::string& file);

/// The same of bytes that have been read already; `file` is only named.
Result<LightProfile> parse_ies(std::string_view text, const std::string& file);

}  // namespace goldthread
