// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/one_line.hpp"
#include "engine/range.hpp"
#include "engine/registry.hpp"
#include "engine/translucency.hpp"
#include "io/message.hpp"
#include "scene/camera_views.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "scene/supersample.hpp"
#include "scene/texture.hpp"
#include "scene/tri_stream.hpp"
#include "scene/wireframe.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

constexpr std::string_view extreme_prefix = "extreme/";
constexpr std::string_view triangles_prefix = "triangles/";

std::vector<double> parse_numbers(const std::string& text, const std::string& option, std::size_t count,
                                  const std::string& expected) {
  const auto numbers = numbers_between_commas(text, count);
  if (!numbers) throw InputError(fmt::format("{}: '{}' is not {}", option, text, expected));
  return *numbers;
}

std::uint8_t color_code(double value, const std::string& option) {
  if (value < 0 || value > 255 || value != std::floor(value)) {
    throw InputError(fmt::format("{}: colour codes are integers 0..255", option));
  }
  return static_cast<std::uint8_t>(value);
}

// The camera flags given, for a scene that has a camera of its own.
void refuse_camera(const std::string& name, const SceneOptions& o) {
  const auto refuse = [&](bool given, std::string_view flag) {
    if (given) {
      throw InputError(fmt::format("{}: {} is for meshes; this scene has its own camera", name, flag));
    }
  };
  refuse(!o.camera.empty(), "--camera");
  refuse(o.yaw.has_value(), "--yaw");
  refuse(o.pitch.has_value(), "--pitch");
  refuse(o.distance.has_value(), "--distance");
  refuse(o.fov.has_value(), "--fov");
  refuse(o.near.has_value(), "--near");
  refuse(o.far.has_value(), "--far");
  refuse(o.projection.has_value(), "--projection");
  refuse(!o.receding.empty(), "--receding");
  refuse(!o.texture.empty(), "--texture");
  refuse(!o.texture1.empty(), "--texture1");
  refuse(!o.light_map.empty(), "--light-map");
  refuse(!o.relief.empty(), "--relief");
  refuse(!o.fog.empty(), "--fog");
  refuse(!o.light.empty(), "--light");
  refuse(o.unlit, "--unlit");
  refuse(o.no_cull, "--no-cull");
  refuse(o.patch_depth.has_value(), "--patch-depth");
  refuse(o.turn.has_value(), "--turntable");
  refuse(o.strict, "--strict");
}

void refuse_stream_options(const std::string& name, const SceneOptions& o) {
  if (o.frame)
    throw InputError(name + ": --frame is for streams (.tri, .trib) with dynamic textures; leave it out");
  if (o.target)
    throw InputError(name +
                     ": --show-target is for streams (.tri, .trib) with several targets; leave it out");
}

// Throws InputError where the stream does not draw on the target of --show-target.
void refuse_target(const std::string& name, int target, const std::set<int>& drawn_on) {
  if (drawn_on.contains(target)) return;
  throw InputError(
      fmt::format("{}: --show-target {}: the stream does not draw on it; expected {}", name, target,
                  drawn_on.size() == 1 ? "0" : fmt::format("one of {}", fmt::join(drawn_on, ", "))));
}

void refuse_size(const std::string& name, const Scene& scene, const SceneOptions& o) {
  if (o.size.empty()) {
    return;
  }
  const Size size = picture_size(o.size);
  if (size.width != scene.width || size.height != scene.height) {
    throw InputError(
        fmt::format("{}: --size {}: this scene's coordinates are pixels of {}x{}; leave --size out", name,
                    o.size, scene.width, scene.height));
  }
}

}  // namespace

std::optional<std::vector<double>> numbers_between_commas(const std::string& text, std::size_t count) {
  std::vector<double> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
    out.push_back(value);
    if (next == end) break;
    if (*next != ',') return std::nullopt;
    at = next + 1;
  }
  if (out.size() != count) return std::nullopt;
  return out;
}

bool is_parallel(const SceneOptions& o) {
  return choice<Projection>(o.projection, "--projection") != Projection::central;
}

Config with_lines(Config config, const SceneOptions& options) {
  if (options.wireframe.empty() || has_lines(config.line_walk)) return config;
  config.line_walk = LineForm::exact;
  check_config(config, "--wireframe: configuration '" + config.name + "'");
  return config;
}

SceneOptions seen_with(const Config& config, SceneOptions options) {
  if (!options.wireframe.empty() && !has_lines(config.line_walk)) {
    throw InputError("--wireframe: expected a configuration with line.walk = \"exact\" or \"dda\"");
  }
  for (const auto& [given, flag] :
       {std::pair{&options.texture1, "--texture1"}, std::pair{&options.light_map, "--light-map"},
        std::pair{&options.relief, "--relief"}}) {
    if (!given->empty() && !has_second_coordinates(config.second_coordinates)) {
      throw InputError(
          fmt::format("{}: the configuration gives the second texture unit the first one's coordinates; "
                      "expected one with texture.second = \"own\"",
                      flag));
    }
  }
  if (is_parallel(options) && !has_own_depth(config.depth_line)) {
    throw InputError(
        fmt::format("--projection {}: its depths are a line of their own; expected a configuration "
                    "with depth.line = \"z\"",
                    *options.projection));
  }
  options.depth_bits = config.depth_bits;
  options.depth_code = config.depth_code;
  options.light_by_unit = has_light(config.light);
  options.light_points = has_light_points(config);
  options.light_relief = has_relief(config);
  options.light_shadow = has_light_shadow(config);
  options.room = room_options(config);
  options.config = config;
  return options;
}

namespace {

// What --shadow and its companions say; none where there is no shadow.
std::optional<ShadowOptions> shadow_of(const SceneOptions& o) {
  if (o.shadow.empty()) {
    for (const auto& [given, flag] : {std::pair{o.shadow_map.has_value(), "--shadow-map"},
                                      {!o.shadow_bias.empty(), "--shadow-bias"},
                                      {o.shadow_dark.has_value(), "--shadow-dark"},
                                      {!o.shadow_plane.empty(), "--shadow-plane"},
                                      {o.shadow_volumes, "--shadow-volumes"}}) {
      if (given)
        throw InputError(fmt::format("{}: is for a shadow; expected --shadow x,y,z beside it", flag));
    }
    return std::nullopt;
  }
  ShadowOptions out;
  const bool has_target = std::ranges::count(o.shadow, ',') > 2;
  const auto n = parse_numbers(o.shadow, "--shadow", has_target ? 7 : 3,
                               has_target ? "a light and what it sees x,y,z,X,Y,Z,degrees" : "a light x,y,z");
  out.light = {n[0], n[1], n[2]};
  if (has_target) {
    out.at = Vec3{n[3], n[4], n[5]};
    out.degrees = n[6];
  }
  if (!o.shadow_plane.empty()) {
    const auto p = parse_numbers(o.shadow_plane, "--shadow-plane", 6, "a point and a normal x,y,z,nx,ny,nz");
    out.plane = Plane{{p[0], p[1], p[2]}, {p[3], p[4], p[5]}};
  }
  out.volumes = o.shadow_volumes;
  if ((out.plane || out.volumes) && (o.shadow_map || !o.shadow_bias.empty() || has_target)) {
    throw InputError(
        fmt::format("{}: needs no map; expected --shadow x,y,z and --shadow-dark alone beside it",
                    out.plane ? "--shadow-plane" : "--shadow-volumes"));
  }
  out.size = o.shadow_map.value_or(out.size);
  if (!o.shadow_bias.empty() && o.shadow_bias != "auto") {
    out.bias = parse_numbers(o.shadow_bias, "--shadow-bias", 1, "a number of texels or auto").front();
  }
  out.depth_bits = o.depth_bits;
  out.depth_code = o.depth_code;
  out.light_takes = o.light_shadow;
  out.dark = o.shadow_dark;
  check_shadow(out, {.light = "--shadow",
                     .at = "--shadow",
                     .degrees = "--shadow",
                     .size = "--shadow-map",
                     .bias = "--shadow-bias",
                     .dark = "--shadow-dark",
                     .plane = "--shadow-plane",
                     .volumes = "--shadow-volumes"});
  return out;
}

// What --light says; none where there is none.
std::optional<LightOptions> light_of(const SceneOptions& o) {
  if (o.light.empty()) return std::nullopt;
  if (o.unlit) throw InputError("--unlit: draws without light; expected no --light beside it");
  // Each form has the numbers of those in front of it.
  struct Form {
    std::size_t count;
    const char* text;
  };
  constexpr Form forms[] = {{3, "a light x,y,z"},
                            {6, "a light and its shares x,y,z,ambient,specular,exponent"},
                            {7, "a light with the lunar law x,y,z,ambient,specular,exponent,lunar"},
                            {9, "a light that falls x,y,z,ambient,specular,exponent,lunar,reach,offset"}};
  const auto given = static_cast<std::size_t>(std::ranges::count(o.light, ',')) + 1;
  const Form* form = std::ranges::find_if(forms, [&](const Form& f) { return given <= f.count; });
  if (form == std::end(forms)) --form;
  const auto n = parse_numbers(o.light, "--light", form->count, form->text);
  LightOptions out{.light = {.is_point = o.light_points, .place = {n[0], n[1], n[2]}},
                   .by_unit = o.light_by_unit};
  if (form->count >= 6) {
    if (n[5] != std::floor(n[5]) || std::abs(n[5]) > light_exponent_limit) {
      throw InputError(fmt::format("--light: the exponent {} is not legal; expected a whole number 1..{}",
                                   n[5], light_exponent_limit));
    }
    out.light.ambient = n[3];
    out.light.specular = n[4];
    out.light.exponent = static_cast<int>(n[5]);
  }
  if (form->count >= 7) out.light.lunar = n[6];
  if (form->count >= 9) {
    out.light.reach = n[7];
    out.light.offset = n[8];
  }
  check_light(out, "--light");
  return out;
}

// Which of others, by their flags, is given beside what says so.
void refuse_beside(std::string_view what,
                   std::initializer_list<std::pair<std::string_view, std::string_view>> others) {
  for (const auto& [given, flag] : others) {
    if (!given.empty()) throw InputError(fmt::format("{}; expected no {} beside it", what, flag));
  }
}

// What --light-map says; none where there is none.
std::optional<LightMapOptions> light_map_of(const SceneOptions& o) {
  if (o.light_map.empty()) return std::nullopt;
  const auto n = parse_numbers(o.light_map, "--light-map", 4, "a light and its reach x,y,z,reach");
  refuse_beside(
      "--light-map: lights by the second texture unit",
      {{o.texture1, "--texture1"}, {o.shadow, "--shadow"}, {o.slide, "--slide"}, {o.light, "--light"}});
  const LightMapOptions out{.place = {n[0], n[1], n[2]}, .reach = n[3]};
  check_light_map(out, "--light-map");
  return out;
}

// What --relief says; none where there is none.
std::optional<std::string> relief_of(const SceneOptions& o) {
  if (o.relief.empty()) return std::nullopt;
  if (!o.light_relief || !o.light_points) {
    throw InputError(
        "--relief: the configuration has no light that takes a map; expected light.at = \"pixel\", "
        "light.source = \"point\" and light.normal = \"map\"");
  }
  if (o.light.empty()) throw InputError("--relief: there is no light; expected --light beside it");
  refuse_beside("--relief: has the second texture unit", {{o.texture1, "--texture1"},
                                                          {o.shadow, "--shadow"},
                                                          {o.slide, "--slide"},
                                                          {o.light_map, "--light-map"}});
  return o.relief;
}

// What --slide and --slide-from say; up: in the image.
std::optional<SlideOptions> slide_of(const SceneOptions& o, const Vec3& up) {
  if (o.slide.empty() != o.slide_from.empty()) {
    throw InputError("--slide, --slide-from: go together; expected an image and x,y,z,X,Y,Z,degrees");
  }
  if (o.slide.empty()) return std::nullopt;
  if (!o.shadow.empty()) {
    throw InputError("--slide: has the unit that --shadow needs; expected one of them");
  }
  const auto n = parse_numbers(o.slide_from, "--slide-from", 7,
                               "a projector, what it points at, and an angle x,y,z,X,Y,Z,degrees");
  return SlideOptions{.image = read_texture(o.slide),
                      .projector = {n[0], n[1], n[2]},
                      .at = {n[3], n[4], n[5]},
                      .up = up,
                      .degrees = n[6]};
}

// What --projection and --receding say. Throws InputError beside what needs the distance from the viewer at
// each pixel, which vertices of one distance do not give.
void set_projection(const SceneOptions& o, Camera& camera) {
  if (!o.receding.empty()) {
    if (o.projection != "oblique") {
      throw InputError(
          "--receding: is for lines away from the viewer; expected --projection oblique beside it");
    }
    const auto n = parse_numbers(o.receding, "--receding", 2, "a length and degrees, as 0.5,45");
    camera.receding = n[0];
    camera.receding_degrees = n[1];
  }
  if (!is_parallel(o)) return;
  camera.projection = choice<Projection>(o.projection, "--projection");
  for (const auto& [given, flag] : {std::pair{!o.fog.empty(), "--fog"},
                                    {!o.shadow.empty(), "--shadow"},
                                    {!o.slide.empty(), "--slide"},
                                    {!o.light_map.empty(), "--light-map"},
                                    {!o.relief.empty(), "--relief"},
                                    {!o.light.empty() && o.light_points, "--light at a point"}}) {
    if (given) {
      throw InputError(
          fmt::format("{}: needs distances from a viewer, which --projection {} does not have; "
                      "expected one of them",
                      flag, *o.projection));
    }
  }
  if (camera.projection != Projection::isometric) return;
  for (const auto& [given, flag] : {std::pair{o.yaw.has_value(), "--yaw"},
                                    {o.pitch.has_value(), "--pitch"},
                                    {!o.camera.empty(), "--camera"}}) {
    if (given) {
      throw InputError(
          fmt::format("{}: --projection isometric has its own direction; expected one of them", flag));
    }
  }
}

LoadedScene load_mesh(const std::string& name, const SceneOptions& o, int number) {
  MeshOptions options;
  const Size size = picture_size(o.size);
  options.width = size.width;
  options.height = size.height;
  Camera& camera = options.camera;
  if (number != 0) set_camera(camera, number);
  camera.yaw_degrees = o.yaw.value_or(camera.yaw_degrees);
  camera.pitch_degrees = o.pitch.value_or(camera.pitch_degrees);
  camera.distance = o.distance;
  if (!o.camera.empty()) {
    const auto p = parse_numbers(o.camera, "--camera", 3, "a position x,y,z");
    camera.position = Vec3{p[0], p[1], p[2]};
  }
  camera.fov_degrees = o.fov;
  set_projection(o, camera);
  camera.s_min = o.near;
  camera.s_max = o.far;
  if (!o.texture.empty()) {
    options.texture = o.texture;
  }
  if (!o.fog.empty()) {
    const auto f = parse_numbers(o.fog, "--fog", 4, "a colour and a distance r,g,b,distance");
    if (f[3] <= 0) {
      throw InputError("--fog: the distance must be positive");
    }
    options.fog =
        Fog{{color_code(f[0], "--fog"), color_code(f[1], "--fog"), color_code(f[2], "--fog")}, f[3]};
  }
  if (!o.texture1.empty()) options.texture1 = o.texture1;
  if (options.texture1 && (!o.shadow.empty() || !o.slide.empty())) {
    throw InputError("--texture1: has the unit that --shadow and --slide need; expected one of them");
  }
  options.light_map = light_map_of(o);
  options.relief = relief_of(o);
  options.project.cull = !o.no_cull;
  options.project.clip_sides = o.clip_sides;
  options.light = light_of(o);
  options.unlit = o.unlit;
  options.shadow = shadow_of(o);
  options.slide = slide_of(o, {0, 1, 0});
  ProjectReport faces;
  std::vector<std::string> bad_textures;
  Mesh mesh = read_mesh(name, options.texture, o.strict ? nullptr : &bad_textures, options.texture1,
                        options.relief, o.patch_depth.value_or(patch_k_default));
  for (const std::string& what : bad_textures) {
    say("bitspan: warning: " + what + "; its faces are white (--strict refuses this)\n");
  }
  for (const std::string& note : mesh.notes) {
    say("bitspan: warning: " + name + ": " + note + "\n");
  }
  if (o.turn) turn_mesh(mesh, options.camera, *o.turn, rotate_formats(o.config.value()));
  Scene scene = mesh_scene(std::move(mesh), options, faces);
  check_scene(scene, name);
  return {std::move(scene), faces};
}

}  // namespace

void add_scene_options(CLI::App& command, SceneOptions& o) {
  const char* group = "Scene";
  command.add_option("--size", o.size, "WxH of the picture (default 640x480; a stream has its own)")
      ->group(group);
  command.add_option("--camera", o.camera, "mesh: x,y,z of the viewer, instead of yaw, pitch, distance")
      ->group(group);
  command.add_option("--yaw", o.yaw, "mesh: degrees around the model (default 150)")->group(group);
  command.add_option("--pitch", o.pitch, "mesh: degrees upward, -89..89 (default 20)")->group(group);
  command.add_option("--distance", o.distance, "mesh: from the model's centre (default: frames it)")
      ->group(group);
  command.add_option("--fov", o.fov, "mesh: degrees of the picture's height, 1..170 (default 40)")
      ->group(group);
  command
      .add_option(
          "--projection", o.projection,
          "mesh: central; or parallel: orthographic, isometric, oblique, as large as the central one at "
          "the model's centre. These need depth.line = \"z\"")
      ->group(group);
  command
      .add_option(
          "--receding", o.receding,
          "mesh: length,degrees of lines away from the viewer in an oblique projection (default 0.5,45)")
      ->group(group);
  command.add_option("--near", o.near, "mesh: s_min (default: just before the model)")->group(group);
  command.add_option("--far", o.far, "mesh: s_max (default: just behind the model)")->group(group);
  command.add_option("--texture", o.texture, "mesh: an image for every face")->group(group);
  command
      .add_option("--patch-depth", o.patch_depth,
                  fmt::format("patches (.bez): 2^N steps each way, N {}..{} (default {})", patch_k_least,
                              patch_k_limit, patch_k_default))
      ->check(CLI::Range(patch_k_least, patch_k_limit))
      ->group(group);
  command
      .add_option("--texture1", o.texture1,
                  "mesh: an image for the second texture unit, at the second coordinates of a glTF. Needs "
                  "texture.second = \"own\"")
      ->group(group);
  command.add_option("--fog", o.fog, "mesh: r,g,b,distance of a fog")->group(group);
  command
      .add_option(
          "--light", o.light,
          "mesh: x,y,z of a light; or x,y,z,ambient,specular,exponent, where ambient and specular are shares "
          "of 1 (default 0.2,0,32). By light.at of the configuration; where that is none, at the vertices in "
          "double precision. Far away, unless light.source = \"point\". Two more forms are "
          "...,exponent,lunar with k of light.law = \"lunar\", and ...,lunar,reach,offset, where brightness "
          "falls by light.fall. A mesh without a texture has one at "
          "the viewer's shoulder")
      ->group(group);
  command.add_flag("--unlit", o.unlit, "mesh: without that light")->group(group);
  command
      .add_option("--light-map", o.light_map,
                  "mesh: x,y,z,reach of a light as a texture of the second unit, which falls with the square "
                  "of the distance; at the reach a surface that faces it is as bright as its colour. Needs "
                  "texture.second = \"own\"")
      ->group(group);
  command
      .add_option(
          "--relief", o.relief,
          "mesh: an image of normals, red along u, green along v downward, blue outward, at the mesh's "
          "texture coordinates, for --light. Needs light.source = \"point\", light.normal = \"map\" and "
          "texture.second = \"own\"")
      ->group(group);
  command
      .add_option(
          "--shadow", o.shadow,
          "x,y,z of a light that casts shadows; or x,y,z,X,Y,Z,degrees: the point that it looks at and "
          "the angle that it sees. Of a mesh and of demo in their world, else as the viewer sees: x to "
          "the right, y down, z forward. Needs project.unit = \"reciprocal\"")
      ->group(group);
  command.add_option("--shadow-map", o.shadow_map, "texels of its map each way (default 1024)")->group(group);
  command
      .add_option("--shadow-bias", o.shadow_bias,
                  "texels that a lit surface may rise towards the light per texel of the map; auto, the "
                  "default: each triangle as its slope asks for")
      ->group(group);
  command
      .add_option(
          "--shadow-plane", o.shadow_plane,
          "x,y,z,nx,ny,nz: a point and the normal, towards the light, of a plane that the shadow falls on "
          "alone; by the stencil, without a map")
      ->group(group);
  command
      .add_flag("--shadow-volumes", o.shadow_volumes,
                "the shadow falls on everything, by bodies that the stencil counts; without a map")
      ->group(group);
  command
      .add_option("--shadow-dark", o.shadow_dark,
                  "what is left in the shadow of a colour (default 0.35), or of what light takes (0)")
      ->group(group);
  command.add_option("--slide", o.slide, "an image that is thrown on the scene, as by --slide-from")
      ->group(group);
  command
      .add_option(
          "--slide-from", o.slide_from,
          "x,y,z,X,Y,Z,degrees: the slide projector, the point in the middle of the image and the angle "
          "of its height. Of a mesh in its world, else as the viewer sees, as --shadow")
      ->group(group);
  command
      .add_option(
          "--translucency", o.translucency,
          "order: triangles are blended in the order of the scene; passes: from back to front at each "
          "pixel, a layer in each pass, as the model finds them (default order)")
      ->type_name("order|passes")
      ->check(CLI::IsMember({"order", "passes"}))
      ->group(group);
  command
      .add_option(
          "--wireframe", o.wireframe,
          "draw the edges of triangles as lines, each once: all of them, or hidden, which removes the "
          "hidden ones; by line.walk = \"exact\" where the configuration has no lines")
      ->type_name("all|hidden")
      ->group(group);
  command
      .add_option("--wireframe-bias", o.wireframe_bias,
                  "hidden: depth codes that lines are nearer by (default: 1/256 of all codes)")
      ->type_name("CODES")
      ->check(CLI::Range(0, 1 << 30))
      ->group(group);
  command.add_flag("--no-cull", o.no_cull, "mesh: draw faces seen from behind too")->group(group);
  command.add_flag("--strict", o.strict, "mesh: refuse it where a texture that it names is missing or bad")
      ->group(group);
  command.add_option("--frame", o.frame, "stream: the image that dynamic textures show at first (default 0)")
      ->type_name("K")
      ->group(group);
  command
      .add_option("--show-target", o.target,
                  "stream: the target that is shown (default: the last one drawn on)")
      ->type_name("K")
      ->group(group);
  add_allow_empty(command, o);
}

SceneOptions parse_scene_flags(std::vector<std::string> flags) {
  SceneOptions out;
  CLI::App app;
  app.set_help_flag();
  add_scene_options(app, out);
  const std::string text = fmt::format("{}", fmt::join(flags, " "));
  std::ranges::reverse(flags);  // as the parser takes them
  try {
    app.parse(std::move(flags));
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("flags of a scene: {}: {}", text, one_line(error.what())));
  }
  return out;
}

void add_supersample(CLI::App& command, SceneOptions& o) {
  command
      .add_option("--supersample", o.supersample,
                  fmt::format("draw K x K samples per pixel, K = 1..{}, and average them", supersample_limit))
      ->type_name("K")
      ->check(CLI::Range(1, supersample_limit))
      ->group("Scene");
}

void add_allow_empty(CLI::App& command, SceneOptions& o) {
  command
      .add_flag("--allow-empty", o.allow_empty,
                "a scene that draws nothing, or a stage that no pixel reaches, is no failure")
      ->group("Scene");
}

std::string faces_text(const ProjectReport& faces) {
  return fmt::format("faces: {} read, {} culled, {} outside, {} drawn{}", faces.faces, faces.culled,
                     faces.outside, faces.drawn,
                     faces.two_sided == 0 ? "" : fmt::format("; {} have two sides", faces.two_sided));
}

std::string faces_line(const LoadedScene& loaded) {
  return loaded.faces ? faces_text(*loaded.faces) + "\n" : "";
}

void refuse_without_faces(const LoadedScene& loaded, const SceneOptions& options) {
  if (!loaded.draws_no_face() || options.allow_empty) return;
  throw NothingDrawn(fmt::format("{}: no face is drawn; {} (--allow-empty accepts this)", loaded.scene.name,
                                 faces_text(*loaded.faces)));
}

Size picture_size(const std::string& text) {
  if (text.empty()) {
    return {};
  }
  const std::optional<Size> size = parse_size(text);
  if (!size) {
    throw InputError(fmt::format("--size: '{}' is no size; expected WIDTHxHEIGHT, such as 640x480", text));
  }
  if (!is_legal(*size)) {
    throw InputError(fmt::format("--size: {} is out of range; expected 1..{} each way and at most {} pixels",
                                 text, picture_size_limit, picture_area_limit));
  }
  return *size;
}

namespace {

// Scenes that a size belongs to. Of a mesh it is what the camera of that number sees, 0 for its own; the
// others leave the camera to load_scenes.
std::vector<LoadedScene> scenes_of_pixels(const std::string& name, const SceneOptions& options, int camera) {
  std::vector<LoadedScene> out;
  refuse_stream_options(name, options);
  if (name == "demo") {
    refuse_camera(name, options);
    const Size size = picture_size(options.size);
    // What another camera sees is not of the demo's world any more.
    const auto shadow = camera == 0 ? shadow_of(options) : std::nullopt;
    out.push_back({demo_scene(size.width, size.height, shadow), std::nullopt});
    return out;
  }
  if (name == "floor" || name == "mirror") {
    refuse_camera(name, options);
    const Size size = picture_size(options.size);
    const auto make = name == "floor" ? floor_scene : mirror_scene;
    out.push_back({make(size.width, size.height), std::nullopt});
    return out;
  }
  if (name == "room") {
    refuse_camera(name, options);
    const Size size = picture_size(options.size);
    out.push_back({room_scene(options.room, size.width, size.height), std::nullopt});
    return out;
  }
  if (name.starts_with(triangles_prefix)) {
    refuse_camera(name, options);
    const Size size = picture_size(options.size);
    int pixels = 0;
    const char* const end = name.data() + name.size();
    const auto [at, error] = std::from_chars(name.data() + triangles_prefix.size(), end, pixels);
    if (error != std::errc{} || at != end || pixels < 1 || pixels > 1024) {
      throw InputError(fmt::format("{}: expected triangles/SIZE, 1..1024 pixels", name));
    }
    Scene scene = triangles_scene(pixels, size.width, size.height);
    scene.name = name;
    out.push_back({std::move(scene), std::nullopt});
    return out;
  }
  if (name == "extreme" || name.starts_with(extreme_prefix)) {
    refuse_camera(name, options);
    std::vector<Scene> all = extreme_scenes();
    if (name != "extreme") {
      const std::string wanted = name.substr(extreme_prefix.size());
      std::string names;
      for (const Scene& scene : all) {
        names += (names.empty() ? "" : ", ") + scene.name;
      }
      std::erase_if(all, [&](const Scene& scene) { return scene.name != wanted; });
      if (all.empty()) {
        throw InputError(fmt::format("{}: no such scene; extreme has {}", name, names));
      }
    }
    for (Scene& scene : all) {
      refuse_size(name, scene, options);
      scene.name = std::string(extreme_prefix) + scene.name;
      out.push_back({std::move(scene), std::nullopt});
    }
    return out;
  }
  out.push_back(load_mesh(name, options, camera));
  out.back().scene.name = camera == 0 ? name : view_name(name, camera);
  return out;
}

Scene whole_stream(const std::string& name, const SceneOptions& options) {
  SceneSource source(name, options);
  Scene scene = source.scene();
  while (const Scene* piece = source.next()) append_piece(scene, *piece);
  return scene;
}

}  // namespace

SceneSource::SceneSource(LoadedScene whole) : loaded_(std::move(whole)), views_(loaded_.scene) {}

SceneSource::SceneSource(const std::string& stream, const SceneOptions& options) : options_(options) {
  refuse_camera(stream, options);
  ShadowOptions codes;
  codes.depth_bits = options.depth_bits;
  codes.depth_code = options.depth_code;
  codes.light_takes = options.light_shadow;
  stream_ = std::make_unique<StreamPieces>(std::make_unique<TriReader>(stream, options.frame, &codes));
  Scene scene = stream_->scene();
  scene.name = stream;
  refuse_size(stream, scene, options);
  loaded_.scene =
      options.supersample > 1 ? supersampled(std::move(scene), options.supersample) : std::move(scene);
  views_ = Views(loaded_.scene);
}

const Scene* SceneSource::next() {
  if (has_ended_) return nullptr;
  first_ = behind_;
  if (stream_ != nullptr) {
    if (!stream_->next(piece_)) return end();
    piece_.name = loaded_.scene.name;
    if (options_.supersample > 1) piece_ = supersampled(std::move(piece_), options_.supersample, first_);
  } else {
    has_ended_ = true;
  }
  const Scene& piece = stream_ != nullptr ? piece_ : loaded_.scene;
  for (const DrawCommand& command : piece.commands) {
    views_.execute(command);
    targets_.insert(views_.target());
  }
  behind_ += static_cast<std::int64_t>(piece.triangles.size());
  return &piece;
}

// Behind a stream: its last piece may be of the target that is to be shown.
const Scene* SceneSource::end() {
  has_ended_ = true;
  if (!options_.target) return nullptr;
  refuse_target(loaded_.scene.name, *options_.target, targets_);
  piece_ = with_view(loaded_.scene);
  piece_.commands.push_back({.before = 0, .what = Target{*options_.target}});
  views_.execute(piece_.commands.back());
  return &piece_;
}

std::optional<Scene> SceneSource::read_again() const {
  if (!can_reread()) return std::nullopt;
  return whole_stream(scene().name, options_);
}

void SceneSource::check_again(const Config& config) const {
  if (!can_reread()) return;
  SceneSource again(scene().name, options_);
  PiecewiseRange range(config, again.scene(), RangeBy::triangles);
  while (const Scene* piece = again.next()) range.add(*piece);
  range.finish();
}

namespace {

// Whether it is a stream as its own camera sees it, which can be drawn while it is read.
bool comes_in_pieces(const std::string& name) { return split_view(name).camera == 0 && is_stream(name); }
bool in_passes(const SceneOptions& options) { return options.translucency == "passes"; }
// Whether the options make something of the whole scene.
bool make_plans(const SceneOptions& o) {
  return !o.shadow.empty() || !o.slide.empty() || !o.wireframe.empty() || in_passes(o);
}
std::optional<WireframeOptions> wireframe_of(const SceneOptions& o) {
  std::optional<Wireframe> kind;
  if (!o.wireframe.empty()) kind = choice<Wireframe>(o.wireframe, "--wireframe");
  if (o.wireframe_bias && !(kind && hides_lines(*kind))) {
    throw InputError("--wireframe-bias: is of hidden lines; give --wireframe hidden too");
  }
  if (!kind) return std::nullopt;
  const int codes = o.wireframe_bias.value_or(wireframe_bias(o.depth_bits));
  return WireframeOptions{*kind, nearer_is_larger(o.depth_code) ? codes : -codes};
}
// Refuses what is not legal before a stream is read.
void refuse_plans(const SceneOptions& options) {
  shadow_of(options);
  wireframe_of(options);
}
// The scene as passes that blend its layers from back to front.
Scene as_passes(Scene scene, const SceneOptions& options) {
  if (!options.config) {
    throw InputError(
        scene.name +
        ": --translucency passes is for one configuration, whose model finds the passes; expected "
        "order");
  }
  check_scene_range(*options.config, scene);
  const std::unique_ptr<Engine> model = make_engine("model", *options.config);
  return in_translucency_passes(std::move(scene), *model);
}

}  // namespace

SceneSource open_scene(const std::string& name, const SceneOptions& options) {
  refuse_plans(options);
  if (comes_in_pieces(name) && !make_plans(options)) return {name, options};
  return SceneSource(load_scene(name, options));
}

std::vector<SceneSource> open_scenes(const std::string& name, const SceneOptions& options, bool whole) {
  refuse_plans(options);
  std::vector<SceneSource> out;
  const bool needs_all = whole || make_plans(options);
  if (comes_in_pieces(name) && name != "-" && !needs_all) {
    out.emplace_back(name, options);
  } else {
    for (LoadedScene& loaded : load_scenes(name, options)) out.emplace_back(std::move(loaded));
  }
  return out;
}

std::function<const Scene*()> pieces_in_range(SceneSource& source, const Config& config) {
  const auto range = std::make_shared<PiecewiseRange>(config, source.scene(), RangeBy::bounds);
  return [&source, &config, range]() -> const Scene* {
    const Scene* const piece = source.next();
    if (piece == nullptr) return nullptr;
    try {
      if (!range->add(*piece)) range->finish();
    } catch (const InputError&) {
      source.check_again(config);
      throw;
    }
    return piece;
  };
}

std::vector<LoadedScene> load_scenes(const std::string& name, const SceneOptions& options) {
  const auto [seen, camera] = split_view(name);
  std::vector<LoadedScene> out;
  const bool streamed = is_stream(seen);
  if (streamed) {
    out.push_back({whole_stream(seen, options), std::nullopt});
  } else {
    out = scenes_of_pixels(seen, options, camera);
  }
  for (LoadedScene& loaded : out) {
    // A mesh has its camera already, and a stream is supersampled as it is read.
    if (camera != 0 && !loaded.faces) loaded.scene = seen_from(loaded.scene, camera);
    // A mesh and the demo have theirs already.
    if (const auto shadow = shadow_of(options); shadow && !loaded.faces && (seen != "demo" || camera != 0)) {
      const std::vector<Face> casters = faces_of(loaded.scene);
      loaded.scene = shadowed(std::move(loaded.scene), casters, *shadow);
    }
    if (!loaded.faces) {
      if (const auto slide = slide_of(options, {0, -1, 0})) {
        loaded.scene = with_slide(std::move(loaded.scene), *slide);
      }
    }
    if (const auto lines = wireframe_of(options)) {
      loaded.scene = wireframe(std::move(loaded.scene), *lines);
    }
    if (options.supersample > 1 && !streamed) {
      loaded.scene = supersampled(std::move(loaded.scene), options.supersample);
    }
    if (in_passes(options)) loaded.scene = as_passes(std::move(loaded.scene), options);
  }
  return out;
}

LoadedScene load_scene(const std::string& name, const SceneOptions& options) {
  std::vector<LoadedScene> all = load_scenes(name, options);
  if (all.size() != 1) {
    std::string names;
    for (const LoadedScene& loaded : all) {
      names += (names.empty() ? "" : ", ") + loaded.scene.name;
    }
    throw InputError(fmt::format("{}: is several scenes; name one: {}", name, names));
  }
  refuse_without_faces(all.front(), options);
  return std::move(all.front());
}

std::string shell_word(const std::string& word) {
  const bool needs_no_quotes = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("_-./,:=+@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (needs_no_quotes) {
    return word;
  }
  std::string out = "'";
  for (const char c : word) {
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return out + "'";
}

std::string command_environment() {
  const std::string root = environment("BITSPAN_ROOT");
  return root.empty() ? "" : "BITSPAN_ROOT=" + shell_word(root) + " ";
}

std::string flags_text(const SceneOptions& o) {
  std::string out;
  const auto text = [&](std::string_view flag, const std::string& value) {
    if (!value.empty()) {
      out += fmt::format(" {} {}", flag, shell_word(value));
    }
  };
  const auto number = [&](std::string_view flag, const std::optional<double>& value) {
    if (value) {
      out += fmt::format(" {} {}", flag, *value);
    }
  };
  text("--size", o.size);
  text("--camera", o.camera);
  number("--yaw", o.yaw);
  number("--pitch", o.pitch);
  number("--distance", o.distance);
  number("--fov", o.fov);
  number("--near", o.near);
  number("--far", o.far);
  text("--projection", o.projection.value_or(""));
  text("--receding", o.receding);
  text("--texture", o.texture);
  text("--texture1", o.texture1);
  text("--fog", o.fog);
  text("--light", o.light);
  text("--light-map", o.light_map);
  text("--relief", o.relief);
  out += o.unlit ? " --unlit" : "";
  text("--shadow", o.shadow);
  text("--shadow-plane", o.shadow_plane);
  out += o.shadow_volumes ? " --shadow-volumes" : "";
  out += o.shadow_map ? fmt::format(" --shadow-map {}", *o.shadow_map) : "";
  text("--shadow-bias", o.shadow_bias);
  number("--shadow-dark", o.shadow_dark);
  text("--slide", o.slide);
  text("--slide-from", o.slide_from);
  out += in_passes(o) ? " --translucency passes" : "";
  text("--wireframe", o.wireframe);
  out += o.wireframe_bias ? fmt::format(" --wireframe-bias {}", *o.wireframe_bias) : "";
  out += o.no_cull ? " --no-cull" : "";
  out += o.strict ? " --strict" : "";
  out += o.frame ? fmt::format(" --frame {}", *o.frame) : "";
  out += o.target ? fmt::format(" --show-target {}", *o.target) : "";
  out += o.allow_empty ? " --allow-empty" : "";
  out += o.supersample > 1 ? fmt::format(" --supersample {}", o.supersample) : "";
  return out;
}

}  // namespace bitspan
