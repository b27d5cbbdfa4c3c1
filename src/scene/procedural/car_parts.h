// The parts of the car. Metres; x to its front, y up, z to its left; it stands on y = 0.
#pragma once
#include "scene/procedural/panels.h"

namespace goldthread::procedural {

/// What the car is made of, as indices of Scene::materials.
struct CarMaterials {
  uint32_t paint, glass, trim, metal, rubber, leather, lining, lamp, tail_lamp;
};

constexpr double kWheelRadius = 0.33;
constexpr double kFrontAxle = 1.36, kRearAxle = -1.34;  ///< x of the wheels' centres
constexpr double kTrack = 0.755;                        ///< distance of the wheels' centres from the middle

/// Fenders, doors, hood, roof, bumpers, windows, lamps: all that is seen from outside but the wheels.
void add_car_body(PanelList& list, const CarMaterials& materials);
/// Dashboard, seats, lining, steering wheel.
void add_car_interior(PanelList& list, const CarMaterials& materials);
/// One wheel round the origin, its outer side at +z.
void add_car_wheel(PanelList& list, const CarMaterials& materials);

/// Half the width of the cabin's lining at the belt line and height of the belt, for what has to fit inside.
double belt_height(double x);
double body_half_width(double x, double y);

}  // namespace goldthread::procedural
