// Light profiles as photometric files.
#pragma once
#include <string>

#include "scene/light_profile.h"

namespace goldthread {

/// LM-63-2002 text of a profile, its values times `scale` as candela. What `parse_ies` makes of it is the
/// same profile; only that tilting changes a lamp's light is lost.
std::string ies_text(const LightProfile& profile, float scale);

}  // namespace goldthread
