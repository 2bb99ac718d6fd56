// SPDX-License-Identifier: Apache-2.0
#include "scene/quad.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "config/toml_section.hpp"
#include "scene/generate/quadric.hpp"

namespace bitspan {
namespace {

template <std::size_t N>
std::array<double, N> numbers(const Section& section, std::string_view key) {
  const std::string legal = std::to_string(N) + " finite numbers";
  const toml::array& list = section.array(key, legal);
  std::array<double, N> out{};
  if (list.size() != N) section.fail(key, "has " + std::to_string(list.size()) + " entries; legal: " + legal);
  for (std::size_t i = 0; i < N; ++i) {
    const auto value = list[i].is_number() ? list[i].value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) section.fail(key, "has something else; legal: " + legal);
    out[i] = *value;
  }
  return out;
}
Vec3 vector_of(const Section& section, std::string_view key) {
  const auto [x, y, z] = numbers<3>(section, key);
  return {x, y, z};
}

QuadricBody body_of(const Section& section, int steps) {
  QuadricBody body;
  body.shape = static_cast<QuadricShape>(section.one_of("shape", enum_names<QuadricShape>));
  if (section.has("radius") == section.has("radii")) {
    section.fail(section.line(), section.path_of("radius"),
                 section.has("radius") ? "stands beside radii; legal: one of them"
                                       : "missing; legal: radius = r or radii = [a, b, c]");
  }
  if (section.has("radius")) body.radii.fill(section.real("radius"));
  if (section.has("radii")) body.radii = numbers<3>(section, "radii");
  if (section.has("from")) body.from = section.real("from");
  if (section.has("to")) body.to = section.real("to");
  if (section.has("caps")) body.caps = section.boolean("caps");
  if (section.has("centre")) body.centre = vector_of(section, "centre");
  if (section.has("axis")) body.axis = vector_of(section, "axis");
  if (section.has("color")) {
    const auto [r, g, b] = numbers<3>(section, "color");
    body.color = {r, g, b, 1};
  }
  body.steps = section.has("steps") ? section.integer("steps") : steps;
  if (section.has("rows")) body.rows = section.integer("rows");
  if (const std::string fault = body_fault(body); !fault.empty()) {
    section.fail(section.line(), section.path_of(fault.substr(0, fault.find(':'))),
                 fault.substr(std::min(fault.size(), fault.find(':') + 2)));
  }
  return body;
}

// `more` behind what is there; its images and materials, too.
void append(MeshFile& to, MeshFile more, const Vec3& at, double scale) {
  const auto images = static_cast<int>(to.images.size());
  const auto materials = static_cast<int>(to.materials.size());
  for (MeshMaterial& material : more.materials) {
    if (material.image >= 0) material.image += images;
    to.materials.push_back(std::move(material));
  }
  for (MeshImage& image : more.images) to.images.push_back(std::move(image));
  for (MeshTriangle& triangle : more.triangles) {
    if (triangle.material >= 0) triangle.material += materials;
    for (MeshCorner& corner : triangle.corner) corner.position = corner.position * scale + at;
    to.triangles.push_back(triangle);
  }
  for (std::string& note : more.notes) to.notes.push_back(std::move(note));
}

}  // namespace

MeshFile read_quad(const std::string& path, const ReadMesh& read_mesh) {
  const std::string text = read_toml_file(path, "scene of quadrics");
  const toml::table table = parse_toml(text, path, "the scene is empty; legal: tables headed [[body]]");
  const Section whole(table, "", 1, path, {"steps", "body", "mesh"});
  const int steps = whole.has("steps")
                        ? static_cast<int>(whole.integer("steps", quadric_steps_least, quadric_steps_limit))
                        : QuadricBody{}.steps;
  MeshFile out;
  const auto bodies = whole.sections(
      "body", {"shape", "radius", "radii", "from", "to", "caps", "centre", "axis", "color", "steps", "rows"});
  if (bodies.empty()) whole.fail(1, "body", "missing; legal: one table headed [[body]] at least");
  if (bodies.size() > quadrics_limit) {
    whole.fail("body", "has more than " + std::to_string(quadrics_limit) + " tables; legal: as many");
  }
  for (const Section& section : bodies) {
    const QuadricBody body = body_of(section, steps);
    if (out.triangles.size() + most_triangles(body) > quadric_triangles_limit) {
      section.fail(
          section.line(), section.path_of("steps"),
          "the scene has too many triangles; legal: " + std::to_string(quadric_triangles_limit) + " in all");
    }
    QuadricMesh made = tessellated(body);
    made.quadric.first = out.triangles.size();
    out.triangles.insert(out.triangles.end(), made.triangles.begin(), made.triangles.end());
    out.quadrics.push_back(made.quadric);
  }
  for (const Section& section : whole.sections("mesh", {"file", "at", "scale"})) {
    const Vec3 at = section.has("at") ? vector_of(section, "at") : Vec3{};
    const double scale = section.has("scale") ? section.real("scale") : 1;
    if (!(scale > 0)) section.fail("scale", "is not legal; legal: a number above 0");
    const std::filesystem::path file = section.text("file", "a mesh file");
    if (file.extension() == ".quad") section.fail("file", "is a scene of quadrics; legal: a mesh file");
    append(out, read_mesh((std::filesystem::path(path).parent_path() / file).string()), at, scale);
  }
  return out;
}

}  // namespace bitspan
