// SPDX-License-Identifier: Apache-2.0
// Errors against `ideal`: of each record, and the metrics of a configuration as `bitspan study` has them.
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <limits>
#include <span>

#include "config/modes.hpp"
#include "engine/records.hpp"
#include "lib/stages.hpp"
#include "python/core/core.hpp"
#include "report/describe.hpp"
#include "report/error.hpp"
#include "study/cost.hpp"
#include "study/metrics.hpp"
#include "study/point.hpp"

namespace bitspan::python {
namespace {

// Whether the study counts the error of a record: one of a pixel that is covered, lives, has fog, and lies in
// the projector's texture.
class Counted {
 public:
  Counted(RecordType type, const Config& config, const Scene& scene)
      : covered_(type == RecordType::fragment ? field_index(type, "covered") : -1),
        killed_(type == RecordType::texture ? field_index(type, "killed") : -1),
        inside_(type == RecordType::project ? field_index(type, "inside") : -1),
        fogged_(type != RecordType::fog || (scene.fog.has_value() && has_fog(config.fog))) {}
  bool operator()(std::span<const std::int64_t> record) const {
    return fogged_ && (covered_ < 0 || record[static_cast<std::size_t>(covered_)] != 0) &&
           (killed_ < 0 || record[static_cast<std::size_t>(killed_)] == 0) &&
           (inside_ < 0 || record[static_cast<std::size_t>(inside_)] != 0);
  }

 private:
  int covered_, killed_, inside_;
  bool fogged_;
};

nb::object errors(const ConfigHandle& handle, const SceneHandle& scene_handle, const std::string& stage,
                  const std::string& field, const Table& records) {
  const RecordType type = capi::stage_types[static_cast<std::size_t>(stage_of(stage))];
  const int index = field_index(type, field);
  if (index < 0)
    throw InputError(stage + "." + field + ": is no field; expected one of bitspan.Config.fields");
  const std::span<const Field> all = fields_of(type);
  const int triangle_field = field_index(type, "triangle");
  if (records.shape(1) != all.size() || triangle_field < 0) {
    throw InputError(stage + ": these are no records of triangles");
  }
  const Config config = handle.full();
  const Scene scene = scene_handle.full();
  if (changes_scene(scene.commands)) {
    throw InputError("errors: the closed form knows one view; expected a scene that no command changes");
  }
  const std::size_t n = records.shape(0);
  auto out = std::make_unique<std::vector<double>>(n, std::numeric_limits<double>::quiet_NaN());
  bool any = n == 0;
  {
    const nb::gil_scoped_release unlocked;
    const Counted counted(type, config, scene);
    const auto column = static_cast<std::size_t>(index);
    std::atomic<bool> found = false;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const std::span<const std::int64_t> record(records.data() + i * all.size(), all.size());
        const std::int64_t triangle = record[static_cast<std::size_t>(triangle_field)];
        if (triangle < 0 || triangle >= static_cast<std::int64_t>(scene.triangles.size()) || !counted(record))
          continue;
        const auto ideal = ideal_value(type, field, record, config, scene,
                                       scene.triangles[static_cast<std::size_t>(triangle)]);
        if (!ideal) continue;
        (*out)[i] = decode(record[column], all[column], config) - *ideal;
        found.store(true, std::memory_order_relaxed);
      }
    });
    any = any || found;
  }
  if (!any)
    throw InputError(stage + "." + field +
                     ": ideal has no value of this field; expected a value of the surface, such as span.u");
  double* const data = out->data();
  nb::capsule owner(out.release(), [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>>(data, {n}, owner));
}

class Meter {
 public:
  explicit Meter(const std::vector<const SceneHandle*>& scenes) : meter_(scenes_of(scenes)) {}
  // Of all scenes together, with what the configuration alone gives; and of each scene that has metrics, with
  // its name.
  using Measured = std::pair<Metrics, std::vector<std::pair<std::string, Metrics>>>;
  Measured measure(const ConfigHandle& config) const {
    const Config full = config.full();
    const nb::gil_scoped_release unlocked;
    PointResult result = meter_.measure(full, false);
    Measured out;
    out.first = std::move(result.metrics);
    for (SceneMetrics& scene : result.scenes) out.second.emplace_back(scene.scene, std::move(scene.metrics));
    return out;
  }

 private:
  static std::vector<Scene> scenes_of(const std::vector<const SceneHandle*>& handles) {
    std::vector<Scene> out;
    for (const SceneHandle* handle : handles) out.push_back(handle->full());
    return out;
  }
  PointMeter meter_;
};

nb::list metrics() {
  nb::list out;
  for (const Metric& m : known_metrics()) {
    out.append(nb::make_tuple(m.name, m.unit, m.better == Better::high, m.meaning));
  }
  return out;
}

}  // namespace

void bind_errors(nb::module_& m) {
  m.def("errors", &errors, nb::arg("config"), nb::arg("scene"), nb::arg("stage"), nb::arg("field"),
        nb::arg("records"),
        nb::sig("def errors(config: ConfigHandle, scene: SceneHandle, stage: str, field: str, records: "
                "numpy.typing.NDArray[numpy.int64]) -> numpy.typing.NDArray[numpy.float64]"));
  m.def("metrics", &metrics, "(name, unit, whether high is better, meaning) of each metric of a study.");
  nb::class_<Meter>(m, "Meter")
      .def(nb::init<const std::vector<const SceneHandle*>&>(), nb::arg("scenes"))
      .def("measure", &Meter::measure, nb::arg("config"));
}

}  // namespace bitspan::python
