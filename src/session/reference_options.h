// What a wish for reference light asks for, and whether it can be granted.
#pragma once
#include <string>

#include "goldthread/reference.h"

namespace goldthread {

/// Whether it goes on from an .exr picture; or from a list of points.
bool resumes_picture(const ReferenceOptions& options);
bool resumes_points(const ReferenceOptions& options);
/// Whether `pictures` are what the camera sees, and not light maps.
bool paints(const ReferenceOptions& options);

/// That exactly one thing is to be measured, numbers are in their ranges, and outputs can be written.
Status check_reference_options(const ReferenceOptions& options);

Error usage_error(std::string message, std::string cure);

}  // namespace goldthread
