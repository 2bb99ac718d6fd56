// SPDX-License-Identifier: Apache-2.0
// bitspan make quadric
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/make_commands.hpp"
#include "cli/make_options.hpp"
#include "cli/scene_options.hpp"
#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "scene/generate/obj_writer.hpp"
#include "scene/generate/quadric.hpp"

namespace bitspan {
namespace {

struct QuadricArguments {
  std::string shape, output;
  std::vector<double> radii{1}, centre, axis;
  std::optional<double> from, to;
  std::optional<int> rows;
  int steps = QuadricBody{}.steps;
  bool open = false;
};

QuadricBody body_of(const QuadricArguments& o) {
  QuadricBody body;
  body.shape = choice<QuadricShape>(o.shape, "SHAPE");
  if (o.radii.size() == 2) throw InputError("--radii: has 2 numbers; expected one, or three a,b,c");
  for (std::size_t i = 0; i < 3; ++i) body.radii[i] = o.radii[o.radii.size() == 3 ? i : 0];
  if (!o.centre.empty()) body.centre = {o.centre[0], o.centre[1], o.centre[2]};
  if (!o.axis.empty()) body.axis = {o.axis[0], o.axis[1], o.axis[2]};
  body.from = o.from;
  body.to = o.to;
  body.caps = !o.open;
  body.steps = o.steps;
  body.rows = o.rows;
  return body;
}

// A scene of this body alone.
std::string scene_text(const QuadricBody& body) {
  const auto& [a, b, c] = body.radii;
  std::string out =
      fmt::format("[[body]]\nshape = \"{}\"\nradii = [{}, {}, {}]\n", to_string(body.shape), a, b, c);
  if (body.from) out += fmt::format("from = {}\n", *body.from);
  if (body.to) out += fmt::format("to = {}\n", *body.to);
  if (!body.caps) out += "caps = false\n";
  const auto vector = [&](const char* key, const Vec3& v) {
    out += fmt::format("{} = [{}, {}, {}]\n", key, v.x, v.y, v.z);
  };
  if (body.centre != Vec3{}) vector("centre", body.centre);
  if (body.axis != QuadricBody{}.axis) vector("axis", body.axis);
  out += fmt::format("steps = {}\n", body.steps);
  if (body.rows) out += fmt::format("rows = {}\n", *body.rows);
  return out;
}

// Numbers vectors by their bits, in the order of their first use.
class Numbered {
 public:
  std::uint32_t operator()(const Vec3& v) {
    const auto [at, is_new] = known_.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(all_.size()));
    if (is_new) all_.push_back(v);
    return at->second;
  }
  const std::vector<Vec3>& all() const { return all_; }

 private:
  std::map<std::array<double, 3>, std::uint32_t> known_;
  std::vector<Vec3> all_;
};

int make_quadric(const QuadricArguments& o) {
  check_output(o.output);
  const QuadricBody body = body_of(o);
  if (const std::string fault = body_fault(body); !fault.empty()) throw InputError("make quadric: " + fault);
  const QuadricMesh mesh = tessellated(body);
  Numbered vertices;
  Numbered normals;
  struct Corners {
    std::array<std::uint32_t, 3> vertex, normal;
  };
  std::vector<Corners> faces;
  for (const MeshTriangle& triangle : mesh.triangles) {
    Corners& face = faces.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      face.vertex[i] = vertices(triangle.corner[i].position);
      face.normal[i] = normals(triangle.corner[i].normal);
    }
  }
  if (o.output.ends_with(".quad")) {
    write_file(o.output, scene_text(body));
  } else {
    ObjWriter out(o.output);
    for (const Vec3& v : vertices.all()) out.vertex(v);
    for (const Vec3& n : normals.all()) out.normal(n);
    for (const Corners& face : faces) out.face(face.vertex, face.normal);
    out.commit();
  }
  fmt::print("{}: {}, {} vertices, {} triangles, {}; f within {:.4g}..{:.4g}\n", o.output,
             to_string(body.shape), vertices.all().size(), faces.size(),
             mesh.quadric.two_sided ? "open" : "closed", mesh.quadric.low, mesh.quadric.high);
  return exit_held;
}

}  // namespace

void add_make_quadric(CLI::App& make, Action& action) {
  CLI::App* sub = make.add_subcommand("quadric", "a body that rays know exactly, as triangles");
  const auto o = std::make_shared<QuadricArguments>();
  sub->add_option("shape", o->shape, "the body; hyperboloid_two has two sheets")
      ->required()
      ->check(CLI::IsMember(names_of<QuadricShape>()));
  sub->add_option("-o,--output", o->output,
                  "OBJ to write; where it ends in .quad, a scene of this body, which rays know")
      ->required();
  sub->add_option("--radii", o->radii, "a, b, c: across the axis, along it, across it; or one for all")
      ->delimiter(',')
      ->expected(1, 3)
      ->capture_default_str();
  sub->add_option("--from", o->from, "height along the axis at which it begins");
  sub->add_option("--to", o->to, "height at which it ends; only whole ellipsoids need none");
  sub->add_option("--centre", o->centre, "x,y,z")->delimiter(',')->expected(3);
  sub->add_option("--axis", o->axis, "x,y,z (default 0,1,0)")->delimiter(',')->expected(3);
  sub->add_flag("--open", o->open, "no flat faces where it is cut");
  sub->add_option("--steps", o->steps, "around the axis")
      ->check(CLI::Range(quadric_steps_least, quadric_steps_limit))
      ->capture_default_str();
  sub->add_option("--rows", o->rows,
                  "along the axis, per sheet (default: 1 of cylinder and cone, else half as many as steps)")
      ->check(CLI::Range(1, quadric_steps_limit));
  sub->footer(help_footer("the file is written", "",
                          "bitspan make quadric sphere --radii 2 -o ball.obj\n"
                          "  bitspan make quadric cone --radii 1,2,1 --from -2 --to 0 -o cone.quad"));
  sub->callback([o, &action] { action = [o] { return make_quadric(*o); }; });
}

}  // namespace bitspan
