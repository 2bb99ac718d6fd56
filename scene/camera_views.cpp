// SPDX-License-Identifier: Apache-2.0
#include "scene/camera_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "scene/mesh.hpp"
#include "scene/project.hpp"
#include "scene/transform.hpp"

namespace bitspan {
namespace {

// Returns three numbers in 0..1 (Roberts' R3 sequence: powers of 1/g with g^4 = g + 1).
std::array<double, 3> place_of(int number) {
  constexpr double g = 1.2207440846057596;
  std::array<double, 3> out{};
  double step = 1;
  for (double& x : out) {
    step /= g;
    x = std::fmod(0.5 + step * number, 1.0);
  }
  return out;
}

double between(double low, double high, double share) { return low + (high - low) * share; }

}  // namespace

FlaggedName split_flags(const std::string& text) {
  const auto at = text.find(" --");
  if (at == std::string::npos) return {text, {}};
  FlaggedName out{text.substr(0, text.find_last_not_of(' ', at) + 1), {}};
  std::istringstream words(text.substr(at));
  for (std::string word; words >> word;) out.flags.push_back(word);
  return out;
}

std::string flagged_name(const FlaggedName& name) {
  std::string out = name.scene;
  for (const std::string& flag : name.flags) out.append(" ").append(flag);
  return out;
}

ViewName split_view(const std::string& name) {
  const auto at = name.rfind('@');
  std::error_code ignored;
  if (at == std::string::npos || at == 0 || std::filesystem::exists(name, ignored)) return {name};
  ViewName out{name.substr(0, at)};
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + at + 1, end, out.camera);
  const bool legal = error == std::errc{} && stop == end && out.camera >= 1 && out.camera <= camera_limit;
  return legal ? out : ViewName{name};
}

std::string view_name(std::string_view scene, int camera) { return fmt::format("{}@{}", scene, camera); }

void set_camera(Camera& camera, int number) {
  const auto [side, height, nearness] = place_of(number);
  camera.yaw_degrees = 360 * side;
  camera.pitch_degrees = between(-45, 65, height);
  camera.closeness = between(0.6, 1.1, nearness);
}

Scene seen_from(const Scene& scene, int camera) {
  if (!scene.commands.empty()) {
    throw InputError(scene.name + ": another camera's view is of a scene without commands; leave @" +
                     std::to_string(camera) + " out");
  }
  if (std::ranges::any_of(scene.triangles, &Triangle::is_line)) {
    throw InputError(scene.name + ": another camera's view is of a scene without lines; leave @" +
                     std::to_string(camera) + " out");
  }
  const std::vector<Face> faces = faces_of(scene);
  double nearest = HUGE_VAL;
  double farthest = 0;
  for (const Face& face : faces) {
    for (const Corner& corner : face.corner) {
      nearest = std::min(nearest, corner.position.z);
      farthest = std::max(farthest, corner.position.z);
    }
  }

  Viewpoint view = viewer_of(scene);
  const auto [side, height, nearness] = place_of(camera);
  const double yaw = radians(between(-20, 20, side));
  const double pitch = radians(between(0, 12, height));
  // The geometric mean, because what is near fills more of the picture.
  const Vec3 middle{0, 0, faces.empty() ? 1 : std::sqrt(nearest * farthest)};
  const double distance = middle.z * between(0.85, 1.1, nearness);
  const Vec3 back{std::sin(yaw) * std::cos(pitch), -std::sin(pitch), -std::cos(yaw) * std::cos(pitch)};
  look_at(view, middle + back * distance, middle, {0, -1, 0});
  for (const Face& face : faces) {
    for (const Corner& corner : face.corner) {
      view.s_max = std::max(view.s_max, 1.01 * dot(view.forward, corner.position - view.position));
    }
  }

  Scene out = scene;
  out.name = view_name(scene.name, camera);
  out.s_max = view.s_max;
  out.triangles.clear();
  out.quadrics.clear();  // what is drawn of them is not what another camera sees
  ProjectReport report;
  project(faces, view, {.cull = false}, out.triangles, report);
  return out;
}

}  // namespace bitspan
