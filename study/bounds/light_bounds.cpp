// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/light_bounds.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "config/modes.hpp"
#include "study/bounds/bounds.hpp"
#include "study/bounds/error_analysis.hpp"

namespace bitspan {

struct LightBounds::Triangles {
  std::vector<bounds::PlaceErrors> errors;
};

LightBounds::LightBounds(const Config& config, const Scene& scene)
    : config_(config), triangles_(std::make_unique<Triangles>()) {
  if (!scene.light || !has_light(config.light)) throw InputError(scene.name + ": has no light to bound");
  check_bounded(config, scene);
  if (const std::string why = unbounded_light(config); !why.empty()) throw InputError(why);
  bounds::ErrorAnalysis analysis(config);
  for (const auto& range : ranges_of_triangles(config, scene)) {
    triangles_->errors.push_back(range ? analysis.run(*range) : bounds::PlaceErrors{});
  }
}

LightBounds::~LightBounds() = default;

LightBound LightBounds::at(std::size_t triangle, const IdealPoint& centre,
                           const std::array<double, 3>& color) const {
  using namespace bounds;
  const PlaceErrors& own = triangles_->errors[triangle];
  if (own.light_unit == nullptr) return {};
  const auto most = [](const ErrorSum& e, double resolution) {
    return next_up(e.total().mag() + resolution);
  };
  LightBound out;
  LightErrors e;
  if (own.light.per_pixel) {
    e = light_at(config_, own, centre);
    for (std::size_t i = 0; i < 3; ++i) {
      out.normal = std::max(out.normal, most(e.normal[i], e.vector_resolution));
      out.direction = std::max(out.direction, most(e.direction[i], e.vector_resolution));
    }
    out.cosine = most(e.cosine, e.cosine_resolution);
    out.mirrored = most(e.mirrored, 3 * e.cosine_resolution);
    out.specular = most(e.specular, e.specular_resolution);
  } else {
    e.value = own.places[light_value].error;
    e.exact_value = own.light.brightness;
    e.value_resolution = own.places[light_value].resolution;
    e.value_unbounded = own.places[light_value].unbounded;
  }
  const double infinite = std::numeric_limits<double>::infinity();
  out.value = e.value_unbounded ? infinite : most(e.value, e.value_resolution);
  for (std::size_t c = 0; c < 3; ++c) {
    out.color[c] = e.value_unbounded
                       ? infinite
                       : most(own.light_unit->color(e, color[c]), color[c] * e.value_resolution);
  }
  return out;
}

}  // namespace bitspan
