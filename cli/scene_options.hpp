// The options that say what is drawn: a scene and, for a mesh, its camera.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/picture_size.hpp"
#include "scene/scene.hpp"

namespace CLI {
class App;
}

namespace bitspan {

struct SceneOptions {
  std::string size;    // "WxH", empty: the stream's own, or 640x480
  std::string camera;  // "x,y,z", empty: an orbit by yaw and pitch
  std::optional<double> yaw, pitch, distance, fov, near, far;
  std::string texture;
  std::string fog;  // "r,g,b,distance"
  bool no_cull = false;
};

void add_scene_options(CLI::App& command, SceneOptions& options);

// What --size says, 640x480 where it is empty; throws InputError where it is no size or beyond what a stream
// may have.
Size picture_size(const std::string& text);

// The scenes that a name stands for: `demo`; `extreme`, which is several, or one of them as `extreme/NAME`; a
// triangle stream (.tri, or - for standard input); or else a mesh. A stream's coordinates are pixels, so its
// size is its own: another --size is refused, and so are camera flags. Throws InputError.
std::vector<Scene> load_scenes(const std::string& name, const SceneOptions& options);
// The same where one picture is wanted.
Scene load_scene(const std::string& name, const SceneOptions& options);

// The flags as they would be typed, each with a space in front; for commands that reproduce.
std::string flags_text(const SceneOptions& options);
// A word for the shell, quoted where it must be.
std::string shell_word(const std::string& word);

}  // namespace bitspan
