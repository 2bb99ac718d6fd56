// SPDX-License-Identifier: Apache-2.0
// Numbered cameras: a scene is seen from as many places as wanted, each of them the same whenever its number
// is named. A scene's name with "@3" behind it is what camera 3 sees of it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan {

struct Camera;

inline constexpr int camera_limit = 999'999;

struct ViewName {
  std::string scene;  // without the camera
  int camera = 0;     // 0: none is named, and the scene has its own
};
// A scene with flags of its own, "demo --shadow=1,2,3": they begin at the first " --", and blanks part them.
struct FlaggedName {
  std::string scene;
  std::vector<std::string> flags;
};
FlaggedName split_flags(const std::string& text);
std::string flagged_name(const FlaggedName& name);

// Splits "spot.obj@3". A name that is a file's, or whose end is no number from 1 to camera_limit, names none.
ViewName split_view(const std::string& name);
std::string view_name(std::string_view scene, int camera);

// Sets the yaw and pitch of a mesh's camera, and how near it is: all around, from 45 degrees below to 65
// above, at 0.6 to 1.1 of the distance at which the whole model is seen. Consecutive numbers spread evenly
// (Roberts' R3 sequence).
void set_camera(Camera& camera, int number);

// Returns what another camera sees of a scene that has its own. It stands on a sphere around the middle of
// the scene's vertices, up to 20 degrees to the side and 12 upward, at 0.85 to 1.1 of the distance. What
// the first camera did not see is not there. Throws InputError for a scene with commands.
Scene seen_from(const Scene& scene, int camera);

}  // namespace bitspan
