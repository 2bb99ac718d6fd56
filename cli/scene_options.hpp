// SPDX-License-Identifier: Apache-2.0
// The options that say what is drawn: a scene and, for a mesh, its camera.
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/turntable.hpp"
#include "config/config.hpp"
#include "scene/picture_size.hpp"
#include "scene/pieces.hpp"
#include "scene/project.hpp"
#include "scene/room.hpp"
#include "scene/scene.hpp"

namespace CLI {
class App;
}

namespace bitspan {

struct SceneOptions {
  std::string size;    // "WxH", empty: the stream's own, or 640x480
  std::string camera;  // "x,y,z", empty: an orbit by yaw and pitch
  std::optional<double> yaw, pitch, distance, fov, near, far;
  std::optional<std::string> projection;  // a name of Projection
  std::string receding;                   // "length,degrees" of an oblique one
  std::string texture, texture1;
  std::string fog;        // "r,g,b,distance"
  std::string light;      // "x,y,z", and ",ambient,specular,exponent", ",lunar" and ",reach,offset" behind it
  std::string light_map;  // "x,y,z,reach"
  std::string relief;     // an image of normals
  bool unlit = false;
  // By the configuration: whether brightness is formed by its unit, and whether lights stand at points.
  bool light_by_unit = false, light_points = false, light_relief = false, light_shadow = false;
  RoomOptions room;          // by the configuration, too
  std::string shadow;        // "x,y,z" or "x,y,z,X,Y,Z,degrees"
  std::string shadow_plane;  // "x,y,z,nx,ny,nz"
  bool shadow_volumes = false;
  std::optional<int> shadow_map;
  std::string shadow_bias;  // a number or "auto"
  std::optional<double> shadow_dark;
  // By what shadows are compared.
  int depth_bits = 16;
  DepthCode depth_code = DepthCode::inverse;
  std::string translucency = "order";  // or "passes"
  std::string wireframe;               // "all" or "hidden"; empty: no lines are made
  std::optional<int> wireframe_bias;   // codes that lines are nearer by
  std::optional<Config> config;        // that the passes are found with
  std::string slide, slide_from;       // an image; "x,y,z,X,Y,Z,degrees"
  bool clip_sides = true;              // a mesh at the picture's borders
  bool no_cull = false;
  bool strict = false;             // a texture that a mesh names must be there
  bool allow_empty = false;        // a scene that draws nothing is no failure
  int supersample = 1;             // samples per pixel, each way
  std::optional<int> patch_depth;  // of patches
  std::optional<Turn> turn;        // of a mesh on a turntable; needs `config`
  std::optional<int> frame;        // which image dynamic textures of a stream show at first
  std::optional<int> target;       // of a stream, that is shown
};

// The configuration that a scene with these options is drawn with: a wire frame takes line.walk = exact where
// the configuration has no lines. Throws InputError where it cannot have any.
Config with_lines(Config config, const SceneOptions& options);
// The options of a scene that is drawn with that configuration. Throws InputError where it lacks what an
// option takes.
SceneOptions seen_with(const Config& config, SceneOptions options);
// None where the text is not so many finite numbers.
std::optional<std::vector<double>> numbers_between_commas(const std::string& text, std::size_t count);

// Whether --projection is a parallel one.
bool is_parallel(const SceneOptions& options);

// The enumerator of that name; the first one where there is none.
template <class E>
E choice(const std::optional<std::string>& text, const char* flag) {
  if (!text) return E{};
  const auto found = std::ranges::find(enum_names<E>, *text);
  if (found == enum_names<E>.end()) {
    throw InputError(
        fmt::format("{}: {} is not legal; expected {}", flag, *text, fmt::join(enum_names<E>, ", ")));
  }
  return static_cast<E>(found - enum_names<E>.begin());
}

// The names that an option takes, for its check.
template <class E>
std::vector<std::string> names_of() {
  return {enum_names<E>.begin(), enum_names<E>.end()};
}

struct LoadedScene {
  Scene scene;
  std::optional<ProjectReport> faces;  // what became of a mesh's faces

  bool draws_no_face() const { return faces && faces->drawn == 0; }
};
// "faces: 12 read, 6 culled, 0 outside, 6 drawn", without the end of the line; and how many are never culled,
// where there are such.
std::string faces_text(const ProjectReport& faces);
// The same with the end of the line, for what a command prints; empty for a scene that is no mesh.
std::string faces_line(const LoadedScene& loaded);

// A mesh of which no face is drawn, and --allow-empty is not given. The command line prints the text, one
// line, and exits with 1.
struct NothingDrawn : std::runtime_error {
  using std::runtime_error::runtime_error;
};
void refuse_without_faces(const LoadedScene& loaded, const SceneOptions& options);

void add_scene_options(CLI::App& command, SceneOptions& options);
// What such flags say. Throws InputError.
SceneOptions parse_scene_flags(std::vector<std::string> flags);
// --allow-empty alone, which add_scene_options has too.
void add_allow_empty(CLI::App& command, SceneOptions& options);

// --supersample, of the commands that average the samples.
void add_supersample(CLI::App& command, SceneOptions& options);

// What --size says, 640x480 where it is empty; throws InputError where it is no size or beyond what a stream
// may have.
Size picture_size(const std::string& text);

// The scenes that a name stands for: `demo`; `extreme`, which is several, or one of them as `extreme/NAME`;
// `triangles/SIZE`, of that many pixels; a triangle stream (is_stream); or else a mesh. A
// stream's coordinates are pixels, so its size is its own: another --size is refused, and so are camera
// flags. With @N behind the name it is what camera N sees of it (scene/camera_views.hpp). A mesh may come
// without a triangle where no face is drawn. With --supersample each scene is as much larger. Throws
// InputError.
std::vector<LoadedScene> load_scenes(const std::string& name, const SceneOptions& options);
// The same where one picture is wanted. Throws NothingDrawn too, as refuse_without_faces.
LoadedScene load_scene(const std::string& name, const SceneOptions& options);

// A scene as a command draws it, piece by piece, so that its memory does not grow with a stream. A scene that
// is no stream is a single piece.
class SceneSource {
 public:
  explicit SceneSource(LoadedScene whole);
  // Of a stream; as load_scene of it.
  SceneSource(const std::string& stream, const SceneOptions& options);

  // Of a stream it has no triangles and no commands.
  const LoadedScene& loaded() const { return loaded_; }
  const Scene& scene() const { return loaded_.scene; }
  // The next triangles with their commands, whose `before` counts from the first of them; null at the end. A
  // piece lives until the next one is asked for; there is one at least. Throws InputError.
  const Scene* next();
  // The index of its first triangle.
  std::int64_t first_index() const { return first_; }
  // Behind the pieces so far.
  const View& view() const { return views_.now(); }
  // All of a stream that comes in pieces, from its file; none of another scene.
  std::optional<Scene> read_again() const;
  // Throws InputError where the formats are not wide enough for that scene, looked at piece by piece.
  void check_again(const Config& config) const;

 private:
  const Scene* end();
  // Whether it is a stream in a file.
  bool can_reread() const { return stream_ != nullptr && scene().name != "-"; }

  SceneOptions options_;
  LoadedScene loaded_;
  std::unique_ptr<StreamPieces> stream_;  // null: the scene is whole
  Scene piece_;                           // of a stream
  Views views_;
  std::set<int> targets_{0};  // drawn on
  std::int64_t first_ = 0, behind_ = 0;
  bool has_ended_ = false;
};

// As load_scene; a stream is read while it is drawn.
SceneSource open_scene(const std::string& name, const SceneOptions& options);
// As load_scenes; a stream that can be read again is read while it is drawn, unless it is wanted whole.
std::vector<SceneSource> open_scenes(const std::string& name, const SceneOptions& options, bool whole);
// Gives the pieces of a source, each once its range has been looked at (engine/range.hpp). Throws InputError
// where the formats are not wide enough; the range of the text is the whole scene's where it can be read
// again. Source and configuration outlive what is returned.
std::function<const Scene*()> pieces_in_range(SceneSource& source, const Config& config);

// The flags as they would be typed, each with a space in front; for commands that reproduce.
std::string flags_text(const SceneOptions& options);
// A word for the shell, quoted where it must be.
std::string shell_word(const std::string& word);
// "BITSPAN_ROOT=FOLDER " where the environment names the RTL under test, for the front of such commands.
std::string command_environment();

}  // namespace bitspan
