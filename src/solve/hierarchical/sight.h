// What is known for certain of the way between two elements.
#pragma once
#include "solve/hierarchical/source_rays.h"

namespace goldthread {

/// kClear where no triangle reaches into the shaft between two elements, between the caps of both
/// (thesis 3.4.1, 6.3.2; E. Haines and J. Wallace, Shaft Culling for Efficient Ray-Cast Radiosity, 1994);
/// then so it is between all that they are divided into. Tested are flat elements, and a flat one with a
/// lamp, a sun without penumbra or a cell of the sky: what is curved stands in its own way. Else kSampled:
/// rays have to tell.
Sight certain_sight(const ElementPool& pool, const Visibility& visibility, ElementId receiver,
                    ElementId source);

}  // namespace goldthread
