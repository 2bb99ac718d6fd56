// SPDX-License-Identifier: Apache-2.0
// Shadows and slides as plans: where the projector sees each vertex, and the commands of the passes. What
// they look like is in tests/golden and tests/report.
#include "scene/shadow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "config/check.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "scene/pieces.hpp"
#include "scene/project.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Vec3 random_point(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

// Small triangles in front of the viewer, s from 20 to 40.
std::vector<Face> random_faces(Random& random, std::size_t count) {
  std::vector<Face> faces(count);
  for (Face& face : faces) {
    const Vec3 middle = random_point(random, 10) + Vec3{0, 0, 30};
    for (Corner& corner : face.corner) {
      corner.position = middle + random_point(random, 1);
      corner.u = random.uniform(0, 9);
    }
    face.two_sided = true;
  }
  return faces;
}

// What the viewer at the origin sees of the faces.
Scene seen(const std::vector<Face>& faces) {
  Scene scene;
  scene.name = "faces";
  scene.width = 320;
  scene.height = 240;
  scene.s_min = 1;
  scene.s_max = 100;
  scene.focal = 300;
  ProjectReport report;
  project(faces, viewer_of(scene), {.cull = false, .clip_sides = false}, scene.triangles, report);
  return scene;
}

Config with_projection() {
  Config config = shipped_config("depth16");
  config.project = ProjectUnit::reciprocal;
  EXPECT_FALSE(first_violation(config));
  return config;
}

void expect_legal(const Scene& scene) {
  EXPECT_EQ(error_of([&] { check_scene(scene, "s"); }), "");
  EXPECT_EQ(error_of([&] { check_commands(with_projection(), scene); }), "");
}

bool gives_projection(const Scene& scene) {
  return std::ranges::any_of(scene.triangles, [](const Triangle& t) {
    return std::ranges::any_of(t.v, [](const Vertex& v) { return v.project_w != 0; });
  });
}

TEST(Shadow, PositionsInvertTheProjection) {
  Random random(1);
  const std::vector<Face> faces = random_faces(random, 200);
  const Scene scene = seen(faces);
  ASSERT_EQ(scene.triangles.size(), faces.size());  // none is clipped
  const std::vector<Face> back = faces_of(scene);
  ASSERT_EQ(back.size(), faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    EXPECT_TRUE(back[i].two_sided);
    EXPECT_EQ(back[i].texture, faces[i].texture);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = faces[i].corner[k].position;
      const Vec3& q = back[i].corner[k].position;
      EXPECT_LT(length(p - q), 1e-12 * length(p)) << i;
      EXPECT_EQ(q.z, scene.triangles[i].v[k].s);
      EXPECT_EQ(q, position_of(scene.triangles[i].v[k], scene));
      EXPECT_EQ(back[i].corner[k].u, faces[i].corner[k].u);
    }
  }
}

// X / W and Y / W are the pixel at which the projector's own picture has the point, and W is its s there.
TEST(Shadow, TheProjectorSeesEachVertexWhereItsPictureHasIt) {
  Random random(2);
  std::size_t compared = 0;
  for (int turn = 0; turn < 20; ++turn) {
    const std::vector<Face> faces = random_faces(random, 20);
    Scene scene = seen(faces);
    ASSERT_EQ(scene.triangles.size(), faces.size());
    Viewpoint projector;
    projector.width = 256;
    projector.height = 64;
    projector.focal = random.uniform(10, 200);
    projector.s_min = 1e-3;
    projector.s_max = 1e3;
    look_at(projector, random_point(random, 60), Vec3{0, 0, 30}, random_point(random, 1));
    give_projection(scene.triangles, scene, projector);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      std::vector<Triangle> picture;
      ProjectReport report;
      project(std::span(faces).subspan(i, 1), projector, {.cull = false, .clip_sides = false}, picture,
              report);
      if (report.clipped != 0 || picture.size() != 1) continue;
      for (std::size_t k = 0; k < 3; ++k, ++compared) {
        const Vertex& v = scene.triangles[i].v[k];
        const Vertex& w = picture[0].v[k];
        EXPECT_NEAR(v.project_w, w.s, 1e-10 * w.s);
        EXPECT_NEAR(v.project_x / v.project_w, w.x, 1e-8 * (1 + std::abs(w.x)));
        EXPECT_NEAR(v.project_y / v.project_w, w.y, 1e-8 * (1 + std::abs(w.y)));
      }
    }
  }
  EXPECT_GT(compared, 600U);
}

// `nearer` moves a point towards the projector along its ray, so that the pixel stays.
TEST(Shadow, NearerStaysAtThePixel) {
  Random random(3);
  Scene scene = seen(random_faces(random, 20));
  Viewpoint projector;
  look_at(projector, {5, -40, 20}, {0, 0, 30}, {0, 0, 1});
  Scene near = scene;
  give_projection(scene.triangles, scene, projector);
  give_projection(near.triangles, near, projector, 0.25);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& v = scene.triangles[i].v[k];
      const Vertex& n = near.triangles[i].v[k];
      EXPECT_NEAR(n.project_w, 0.75 * v.project_w, 1e-12 * std::abs(v.project_w));
      EXPECT_NEAR(n.project_x / n.project_w, v.project_x / v.project_w, 1e-8);
    }
  }
}

// Without an angle the light sees all that is in front of it, within the map and its range.
TEST(Shadow, TheLightSeesAllCasters) {
  Random random(4);
  for (int turn = 0; turn < 50; ++turn) {
    const std::vector<Face> faces = random_faces(random, 30);
    ShadowOptions options;
    options.light = random_point(random, 1);
    options.light = Vec3{0, 0, 30} + options.light * (60 / length(options.light));
    options.size = 1 << random.integer(0, 10);
    const Viewpoint light = view_of(faces, options);
    EXPECT_EQ(light.position, options.light);
    EXPECT_EQ(light.width, options.size);
    EXPECT_EQ(light.height, options.size);
    for (const Face& face : faces) {
      for (const Corner& corner : face.corner) {
        const Vec3 p = in_view(corner.position, light);
        EXPECT_GT(p.z, light.s_min);
        EXPECT_LT(p.z, light.s_max);
        EXPECT_LT(std::abs(p.x * light.focal / p.z), options.size / 2.0);
        EXPECT_LT(std::abs(p.y * light.focal / p.z), options.size / 2.0);
      }
    }
  }
}

TEST(Shadow, TheLightLooksWhereItIsTold) {
  Random random(5);
  const std::vector<Face> faces = random_faces(random, 30);
  ShadowOptions options{.light = {0, -50, 30}, .at = Vec3{0, 0, 30}, .degrees = 90, .size = 64};
  const Viewpoint light = view_of(faces, options);
  EXPECT_EQ(light.forward, (Vec3{0, 1, 0}));
  EXPECT_NEAR(light.focal, 32, 1e-12);
  // Along each axis and back, whatever is up there.
  for (const Vec3& from :
       {Vec3{50, 0, 30}, Vec3{-50, 0, 30}, Vec3{0, 50, 30}, Vec3{0, 0, 90}, Vec3{0, 0, -30}}) {
    options.light = from;
    EXPECT_EQ(error_of([&] { static_cast<void>(view_of(faces, options)); }), "");
  }
  options.light = *options.at;
  expect_refusal([&] { view_of(faces, options); }, "shadow: the light stands at what it looks at");
  options.light = {-1.7e308, 0, 0};
  options.at = {1.7e308, 0, 0};
  expect_refusal([&] { view_of(faces, options); }, "too far away; expected another point");
}

TEST(Shadow, ThePlan) {
  Random random(6);
  const std::vector<Face> faces = random_faces(random, 30);
  Scene scene = seen(faces);
  scene.textures.push_back({"own", 1, 1, {1, 2, 3, 255}});
  scene.fog = Fog{{1, 2, 3}, 50};
  const std::size_t count = scene.triangles.size();
  const ShadowOptions options{.light = {0, -40, 20}, .size = 128, .bias = 2, .dark = 0.5};
  const Scene out = shadowed(scene, faces, options);
  expect_legal(out);
  const Viewpoint light = view_of(faces, options);
  ASSERT_EQ(out.textures.size(), 2U);
  EXPECT_EQ(out.textures[0].name, "own");
  EXPECT_EQ(out.textures[1].width, 128);
  EXPECT_EQ(out.textures[1].rgba.size(), std::size_t{4} * 128 * 128);
  EXPECT_EQ(out.projector, (Projector{light.s_min, light.s_max}));
  ASSERT_EQ(out.triangles.size(), faces.size() + count);

  // The map: the light's view on target 1, without colours, fog and projector.
  const View map = view_at(out, 0);
  EXPECT_EQ(std::pair(map.width, map.height), std::pair(128, 128));
  EXPECT_EQ(std::pair(map.s_min, map.s_max), std::pair(light.s_min, light.s_max));
  EXPECT_EQ(map.focal, light.focal);
  EXPECT_FALSE(map.fog);
  EXPECT_FALSE(map.projector);
  // The picture: the scene's own view.
  EXPECT_EQ(view_at(out, faces.size()), static_cast<const View&>(out));
  EXPECT_EQ(out.fog, scene.fog);

  std::vector<std::string> commands;
  DrawState state = first_state(with_projection());
  for (const DrawCommand& command : out.commands) {
    if (const auto* target = std::get_if<Target>(&command.what)) {
      EXPECT_EQ(target->k, command.before == 0 ? 1 : 0);
      commands.emplace_back("target");
    } else if (const auto* copy = std::get_if<Copy>(&command.what)) {
      EXPECT_EQ(copy->target, 1);
      EXPECT_EQ(copy->plane, CopyPlane::depth);
      EXPECT_EQ(copy->texture, 1);
      EXPECT_EQ(command.before, faces.size());
      commands.emplace_back("copy");
    } else if (const auto* change = std::get_if<StateChange>(&command.what)) {
      state = changed_state(state, *change, with_projection(), out.textures.size());
      EXPECT_EQ(is_projected(state), command.before != 0);
      EXPECT_EQ(state.color_write, command.before != 0);
      commands.emplace_back("state");
    } else {
      EXPECT_TRUE(std::holds_alternative<ViewChange>(command.what));
      commands.emplace_back("view");
    }
  }
  EXPECT_EQ(commands, (std::vector<std::string>{"target", "view", "state", "copy", "target", "state"}));
  EXPECT_EQ(state.texture1, 1);
  EXPECT_TRUE(state.texture1_compare);
  EXPECT_EQ(state.texture1_red, 128);
  EXPECT_EQ(state.texture1_green, 128);
  EXPECT_EQ(state.texture1_blue, 128);
  EXPECT_EQ(state.texture1_op, TextureOp::modulate);
  EXPECT_EQ(state.texture1_outside, ProjectOutside::lit);

  // A light takes the shadow where the configuration lets it, and the view has one.
  const auto op_of = [&](Scene lit, bool takes, std::optional<double> dark) {
    ShadowOptions by = options;
    by.light_takes = takes;
    by.dark = dark;
    DrawState last = first_state(with_projection());
    const Scene drawn = shadowed(std::move(lit), faces, by);
    for (const DrawCommand& command : drawn.commands) {
      if (const auto* change = std::get_if<StateChange>(&command.what)) {
        last = changed_state(last, *change, with_projection(), drawn.textures.size());
      }
    }
    return std::pair(last.texture1_op, last.texture1_red);
  };
  Scene lit = scene;
  lit.light.emplace();
  EXPECT_EQ(op_of(lit, true, {}), std::pair(TextureOp::shadow, 0));
  EXPECT_EQ(op_of(lit, true, 0.5), std::pair(TextureOp::shadow, 128));
  EXPECT_EQ(op_of(lit, false, {}), std::pair(TextureOp::modulate, 89));
  EXPECT_EQ(op_of(scene, true, {}), std::pair(TextureOp::modulate, 89));

  // The picture's triangles are the scene's, with what the light sees of them, a little nearer.
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& was = scene.triangles[i].v[k];
      const Vertex& v = out.triangles[faces.size() + i].v[k];
      EXPECT_EQ(std::tuple(v.x, v.y, v.s, v.u), std::tuple(was.x, was.y, was.s, was.u));
      const double s = dot(light.forward, position_of(was, scene) - light.position);
      EXPECT_NEAR(v.project_w, s * (1 - 0.5 * *options.bias / light.focal), 1e-9 * s);
    }
  }
  // Without a bias, by the share of each triangle.
  ShadowOptions own = options;
  own.bias.reset();
  const Scene by_slope = shadowed(scene, faces, own);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = bias_of(scene.triangles[i], scene, light, 16).nearer;
    const double s = dot(light.forward, position_of(scene.triangles[i].v[1], scene) - light.position);
    EXPECT_NEAR(by_slope.triangles[faces.size() + i].v[1].project_w, s * (1 - share), 1e-9 * s);
  }
  // A triangle without area has one, too; and one in whose plane the light stands.
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {10.0, 5.0}, {0.0, 40.0}}) {
    Triangle thin = scene.triangles[0];
    thin.v[1] = thin.v[2] = thin.v[0];
    thin.v[1].x += x;
    thin.v[2].s += y;
    for (const int bits : {8, 16, 32}) {
      const ShadowBias bias = bias_of(thin, scene, light, bits);
      EXPECT_LT(std::abs(bias.nearer), 1e3);
      EXPECT_LE(std::abs(bias.codes), 1 << 30);
    }
  }
  // A stream keeps it all.
  const TemporaryFolder folder;
  write_tri_file(folder.path("s.tri"), out);
  const Scene back = read_tri(folder.path("s.tri"));
  EXPECT_TRUE(back.commands == out.commands);
  EXPECT_EQ(back.projector, out.projector);
  EXPECT_EQ(back.triangles.back().v[2].project_x, out.triangles.back().v[2].project_x);
}

TEST(Shadow, InTheWorldAsInTheViewersSpace) {
  Random random(7);
  Viewpoint view;
  view.width = 320;
  view.height = 240;
  view.focal = 300;
  look_at(view, {12, 30, -50}, {0, 0, 30}, {0, 1, 0});
  const std::vector<Face> world = random_faces(random, 20);
  std::vector<Face> own = world;
  for (Face& face : own) {
    for (Corner& corner : face.corner) corner.position = in_view(corner.position, view);
  }
  const Scene scene = seen(own);
  ShadowOptions options{.light = {3, 60, 20}, .at = Vec3{0, 1, 29}, .degrees = 40, .size = 64};
  const Scene a = shadowed(scene, world, options, view);
  options.light = in_view(options.light, view);
  options.at = in_view(*options.at, view);
  const Scene b = shadowed(scene, own, options);
  std::ostringstream first, second;
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  EXPECT_EQ(a.projector, b.projector);
  EXPECT_TRUE(a.commands == b.commands);
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(a.triangles[i].v[k].project_w, b.triangles[i].v[k].project_w);
      EXPECT_EQ(a.triangles[i].v[k].x, b.triangles[i].v[k].x);
    }
  }
}

TEST(Shadow, LightsInsideAndBesideTheScene) {
  Random random(8);
  std::size_t drawn = 0;
  for (int turn = 0; turn < 40; ++turn) {
    const std::vector<Face> faces = random_faces(random, 30);
    ShadowOptions options{.light = Vec3{0, 0, 30} + random_point(random, 12), .size = 64};
    options.degrees = turn % 2 == 0 ? 0 : random.uniform(0.01, 159.9);
    if (turn % 3 == 0) options.at = Vec3{0, 0, 30} + random_point(random, 50);
    const Scene out = shadowed(seen(faces), faces, options);
    expect_legal(out);
    drawn += out.commands.empty() ? 0 : 1;
    if (!out.commands.empty()) {
      EXPECT_LT(out.projector->s_min, out.projector->s_max);
    }
  }
  EXPECT_GT(drawn, 20U);
}

// Then everything is lit, and the scene is what it was.
TEST(Shadow, LightsThatSeeNothing) {
  Random random(9);
  const std::vector<Face> faces = random_faces(random, 30);
  const Scene scene = seen(faces);
  const auto expect_as_it_was = [&](const Scene& out) {
    EXPECT_TRUE(out.commands.empty());
    EXPECT_FALSE(out.projector);
    EXPECT_EQ(out.textures.size(), scene.textures.size());
    EXPECT_EQ(out.triangles.size(), scene.triangles.size());
    EXPECT_FALSE(gives_projection(out));
    EXPECT_EQ(error_of([&] { check_scene(out, "s"); }), "");
  };
  // It looks away.
  expect_as_it_was(
      shadowed(scene, faces, {.light = {0, -60, 30}, .at = Vec3{0, -90, 30}, .degrees = 60, .size = 64}));
  // There is nothing to see.
  expect_as_it_was(shadowed(scene, {}, {.light = {0, -60, 30}, .size = 64}));
  const Viewpoint nothing = view_of({}, {.light = {0, -60, 30}, .size = 64});
  EXPECT_TRUE(0 < nothing.s_min && nothing.s_min < nothing.s_max && std::isfinite(nothing.s_max));
  EXPECT_TRUE(std::isfinite(nothing.focal) && nothing.focal > 0);
}

TEST(Shadow, EmptyScenesStayEmpty) {
  const Scene out = shadowed(Scene{}, {}, {.light = {0, -60, 30}});
  EXPECT_TRUE(out.commands.empty() && out.textures.empty() && !out.projector);
  EXPECT_TRUE(
      with_slide(Scene{}, SlideOptions{.image = {}, .projector = {}, .at = {0, 0, 1}}).commands.empty());
}

TEST(Shadow, BadOptionsAreOneLine) {
  Random random(10);
  const std::vector<Face> faces = random_faces(random, 3);
  const Scene scene = seen(faces);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const ShadowOptions good{.light = {0, -60, 30}, .at = Vec3{0, 0, 30}, .degrees = 60, .size = 64};
  ASSERT_EQ(error_of([&] { check_shadow(good); }), "");
  const auto refused = [&](const std::string& line, const std::function<void(ShadowOptions&)>& change) {
    ShadowOptions bad = good;
    change(bad);
    EXPECT_EQ(input_error([&] { check_shadow(bad); }), line);
    EXPECT_EQ(input_error([&] { shadowed(scene, faces, bad); }), line);
  };
  refused("shadow.light: nan is not legal; expected finite numbers", [](auto& o) { o.light.y = nan; });
  refused("shadow.light: -inf is not legal; expected finite numbers", [](auto& o) { o.light.x = -HUGE_VAL; });
  refused("shadow.at: nan is not legal; expected finite numbers", [](auto& o) { o.at->z = nan; });
  for (const double degrees : {-1.0, 160.0, 0.001}) {
    std::ostringstream is;
    is << degrees;
    refused("shadow.degrees: " + is.str() + " is not legal; expected 0, or 0.01 to below 160",
            [&](auto& o) { o.degrees = degrees; });
  }
  refused("shadow.degrees: nan is not legal; expected 0, or 0.01 to below 160",
          [](auto& o) { o.degrees = nan; });
  refused("shadow.size: 0 is not legal; expected 1..8192 texels", [](auto& o) { o.size = 0; });
  refused("shadow.size: 8193 is not legal; expected 1..8192 texels", [](auto& o) { o.size = 8193; });
  refused("shadow.bias: -1 is not legal; expected 0..64 texels", [](auto& o) { o.bias = -1; });
  refused("shadow.bias: 65 is not legal; expected 0..64 texels", [](auto& o) { o.bias = 65; });
  refused("shadow.bias: nan is not legal; expected 0..64 texels", [&](auto& o) { o.bias = nan; });
  refused("shadow.dark: 1.5 is not legal; expected 0..1", [](auto& o) { o.dark = 1.5; });
  refused("shadow.dark: nan is not legal; expected 0..1", [nan](auto& o) { o.dark = nan; });
  // The names are the caller's.
  ShadowOptions bad = good;
  bad.size = 0;
  expect_refusal([&] { check_shadow(bad, {.size = "--shadow-map"}); }, "--shadow-map: 0 is not legal");
  // The ends.
  for (const double end : {0.0, 1.0}) {
    ShadowOptions o = good;
    o.dark = end;
    o.bias = 64 * end;
    o.size = end == 0 ? 1 : 512;
    o.degrees = end == 0 ? 0.01 : 159.9;
    expect_legal(shadowed(scene, faces, o));
  }
}

TEST(Shadow, ScenesWithCommandsAreRefused) {
  Random random(11);
  const std::vector<Face> faces = random_faces(random, 3);
  Scene scene = seen(faces);
  const ShadowOptions options{.light = {0, -60, 30}, .size = 16};
  const SlideOptions slide{
      .image = {"slide", 2, 1, {1, 2, 3, 255, 4, 5, 6, 255}}, .projector = {0, -60, 30}, .at = {0, 0, 30}};
  const Scene once = shadowed(scene, faces, options);
  const std::string line = "faces: a shadow is for a scene without commands and projector; leave it out";
  EXPECT_EQ(input_error([&] { shadowed(once, faces, options); }), line);
  expect_refusal([&] { with_slide(once, slide); }, "faces: a slide is for a scene without commands");
  scene.projector = Projector{1, 2};
  EXPECT_EQ(input_error([&] { shadowed(scene, faces, options); }), line);
  expect_refusal([&] { with_slide(scene, slide); }, "faces: a slide is for");
}

std::string text_of(const Scene& scene) {
  std::ostringstream out;
  write_tri(out, scene);
  return out.str();
}
// A stream whose header has that shadow besides.
std::string with_header_shadow(const Scene& scene, const std::string& shadow) {
  std::string text = text_of(scene);
  text.replace(text.find("\"bitspan\":1"), 11, "\"bitspan\":2");
  return text.insert(text.find("}\n"), ",\"shadow\":" + shadow);
}

TEST(Shadow, InTheHeaderOfAStream) {
  Random random(99);
  const Scene scene = seen(random_faces(random, 40));
  ASSERT_GT(scene.triangles.size(), 10U);
  const Vec3 light{-3, -9, 2};
  const std::pair<std::string, ShadowOptions> cases[] = {
      {R"({"light": [-3, -9, 2]})", {.light = light}},
      {R"({"light": [-3, -9, 2], "bias": "auto", "dark": 0.5})", {.light = light, .dark = 0.5}},
      {R"({"light": [-3, -9, 2], "at": [0, 1, 30], "degrees": 50, "map": 64, "bias": 2.5})",
       {.light = light, .at = Vec3{0, 1, 30}, .degrees = 50, .size = 64, .bias = 2.5}},
      {R"({"light": [-3, -9, 2], "plane": [0, 5, 0, 0, 1, 0]})",
       {.light = light, .plane = Plane{{0, 5, 0}, {0, 1, 0}}}},
      {R"({"light": [-3, -9, 2], "volumes": true})", {.light = light, .volumes = true}}};
  for (const auto& [json, options] : cases) {
    const std::string stream = with_header_shadow(scene, json);
    const std::string expected = text_of(shadowed(scene, faces_of(scene), options));
    EXPECT_EQ(text_of(parse_tri(stream, "x.tri")), expected) << json;
    // In pieces, and with the codes that a configuration has.
    std::istringstream in(stream);
    StreamPieces pieces(std::make_unique<TriReader>(in, "x.tri"), 7);
    Scene whole = pieces.scene();
    for (Scene piece; pieces.next(piece);) append_piece(whole, piece);
    EXPECT_EQ(text_of(whole), expected) << json;
    ShadowOptions finer = options;
    finer.depth_bits = 24;
    finer.depth_code = DepthCode::opengl;
    std::istringstream again(stream);
    TriReader reader(again, "x.tri", std::nullopt, &finer);
    Scene read = reader.scene();
    for (Triangle t; reader.next(t);) read.triangles.push_back(t);
    read.commands = reader.take_commands();
    EXPECT_EQ(text_of(read), text_of(shadowed(scene, faces_of(scene), finer))) << json;
  }
}

TEST(Shadow, BadHeadersAreOneLine) {
  Random random(5);
  const Scene scene = seen(random_faces(random, 3));
  const auto refused = [&](const std::string& json) {
    return input_error([&] { parse_tri(with_header_shadow(scene, json), "x.tri"); });
  };
  const std::pair<const char*, const char*> cases[] = {
      {"3", "shadow: 3 is not an object; expected {\"light\": [x,y,z]}"},
      {"{}", "shadow.light: key is missing; expected [x, y, z]"},
      {R"({"light": [1, 2]})", "shadow.light: has 2 elements; expected [x, y, z]"},
      {R"({"light": [1, 2, "3"]})", "shadow.light: \"3\" is not a number"},
      {R"({"light": [1, 2, 3], "colour": 1})", "shadow.\"colour\": unknown key; expected light, at"},
      {R"({"light": [1, 2, 3], "map": 0})", "shadow.map: 0 is not legal; expected a whole number 1..8192"},
      {R"({"light": [1, 2, 3], "degrees": 170})", "shadow.degrees: 170 is not legal"},
      {R"({"light": [1, 2, 3], "bias": "none"})", "shadow.bias: \"none\" is not a number"},
      {R"({"light": [1, 2, 3], "bias": 65})", "shadow.bias: 65 is not legal; expected 0..64 texels"},
      {R"({"light": [1, 2, 3], "dark": 2})", "shadow.dark: 2 is not legal"},
      {R"({"light": [1, 2, 3], "volumes": 1})", "shadow.volumes: 1 is not legal; expected true or false"},
      {R"({"light": [1, 2, 3], "volumes": true, "map": 9})", "shadow.map: is of a map"},
      {R"({"light": [1, 2, 3], "plane": [0, 0, 0, 0, 0, 0]})", "shadow.plane: 0 is not legal"},
      {R"({"light": [1, 2, 3], "at": [1, 2, 3]})", "shadow: the light stands at what it looks at"},
  };
  for (const auto& [json, message] : cases) {
    EXPECT_EQ(refused(json).find("x.tri:1: " + std::string(message)), 0U) << refused(json);
  }
  std::string old = with_header_shadow(scene, R"({"light": [1, 2, 3]})");
  old.replace(old.find("\"bitspan\":2"), 11, "\"bitspan\":1");
  EXPECT_EQ(input_error([&] { parse_tri(old, "x.tri"); }),
            "x.tri:1: shadow: is not legal in version 1; expected \"bitspan\": 2");
  const std::string commands =
      with_header_shadow(scene, R"({"light": [1, 2, 3]})") + "{\"clear\": {\"depth\": true}}\n";
  EXPECT_EQ(input_error([&] {
              parse_tri(commands, "x.tri");
            }).find("x.tri:1: shadow: x: a shadow is for a scene without"),
            0U)
      << input_error([&] { parse_tri(commands, "x.tri"); });
}

TEST(Shadow, ASlide) {
  Random random(12);
  const Scene scene = seen(random_faces(random, 10));
  const SlideOptions slide{.image = {"slide", 2, 1, {1, 2, 3, 255, 4, 5, 6, 255}},
                           .projector = {0, -60, 30},
                           .at = {0, 0, 30},
                           .up = {0, 0, 1},
                           .degrees = 360 / std::numbers::pi * std::atan(0.5)};
  Viewpoint projector;
  projector.width = 2;
  projector.height = 1;
  projector.focal = 1;
  look_at(projector, slide.projector, slide.at, slide.up);
  const Scene out = with_slide(scene, slide);
  expect_legal(out);
  ASSERT_EQ(out.commands.size(), 1U);
  EXPECT_EQ(out.commands[0].before, 0U);
  const int texture = static_cast<int>(scene.textures.size());
  const DrawState state =
      changed_state(first_state(with_projection()), std::get<StateChange>(out.commands[0].what),
                    with_projection(), out.textures.size());
  EXPECT_TRUE(is_projected(state));
  EXPECT_EQ(state.texture1, texture);
  EXPECT_EQ(state.texture1_outside, ProjectOutside::dark);
  EXPECT_EQ(state.texture1_op, TextureOp::modulate);
  EXPECT_FALSE(state.texture1_compare);
  ASSERT_EQ(out.triangles.size(), scene.triangles.size());
  double farthest = 0;
  for (std::size_t i = 0; i < out.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& v = out.triangles[i].v[k];
      const Vec3 p = in_view(position_of(scene.triangles[i].v[k], scene), projector);
      EXPECT_NEAR(v.project_w, p.z, 1e-9);
      EXPECT_NEAR(v.project_x, p.x + p.z, 1e-9);
      EXPECT_NEAR(v.project_y, p.y + p.z / 2, 1e-9);
      farthest = std::max(farthest, v.project_w);
    }
  }
  EXPECT_EQ(out.projector->s_max, farthest);
  SlideOptions wide = slide;
  wide.degrees = 160;
  EXPECT_NE(error_of([&] { with_slide(scene, wide); }).find("slide: 160 degrees are not legal"),
            std::string::npos);
  EXPECT_NE(error_of([&] { with_slide(out, slide); }).find("a slide is for a scene without commands"),
            std::string::npos);
}

TEST(Shadow, OfTheDemoAndOfMeshes) {
  const Scene demo = demo_scene(160, 120);
  const Scene lit = demo_scene(160, 120, ShadowOptions{.light = {30, 60, 0}, .size = 128});
  expect_legal(lit);
  EXPECT_GT(lit.triangles.size(), demo.triangles.size());
  EXPECT_TRUE(gives_projection(lit));
  MeshOptions options;
  options.width = 64;
  options.height = 48;
  ProjectReport report;
  const Mesh spot = read_mesh(source_path("tests/data/spot.obj"));
  const Scene plain = mesh_scene(spot, options, report);
  options.shadow = ShadowOptions{.light = {3, 4, -3}, .size = 128};
  const Scene shaded = mesh_scene(spot, options, report);
  expect_legal(shaded);
  EXPECT_GT(shaded.triangles.size(), plain.triangles.size());
  // The same picture's triangles, behind those of the map.
  const std::size_t first = shaded.triangles.size() - plain.triangles.size();
  EXPECT_EQ(shaded.triangles[first].v[0].x, plain.triangles[0].v[0].x);
  EXPECT_EQ(shaded.textures.size(), plain.textures.size() + 1);
}

}  // namespace
}  // namespace bitspan
