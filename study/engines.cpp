#include "study/engines.hpp"

#include <stdexcept>
#include <string>

#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "tb/engine_rtl.hpp"

namespace bitspan {

std::unique_ptr<Engine> engine_named(std::string_view name, const Config& config) {
  if (name == "ideal") return make_ideal(config);
  if (name == "golden") return make_golden(config);
  if (name == "model") return make_model(config);
  if (name == "rtl") return make_rtl(config);
  throw std::invalid_argument("no engine is named " + std::string(name));
}

Frame drawn(std::string_view engine, const Config& config, const Scene& scene) {
  const auto made = engine_named(engine, config);
  made->begin(scene);
  made->draw(scene.triangles, 0, nullptr);
  return made->frame();
}

}  // namespace bitspan
