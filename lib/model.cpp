// SPDX-License-Identifier: Apache-2.0
#include "lib/model.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "config/modes.hpp"
#include "engine/registry.hpp"
#include "lib/config.hpp"
#include "lib/engines.hpp"
#include "lib/handles.hpp"
#include "lib/records.hpp"
#include "lib/scene.hpp"
#include "lib/stages.hpp"
#include "lib/structs.hpp"
#include "model/engine_override.hpp"
#include "model/pipeline.hpp"
#include "report/position.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan::capi {
namespace {

// Never destroyed: functions may be called while the program ends.
Handles<bs_model, ModelState>& models() {
  static auto* const all = new Handles<bs_model, ModelState>("bs_model");
  return *all;
}

// A model for the time of a call. Throws BS_BAD_HANDLE, or BS_BUSY.
class Use {
 public:
  Use(const bs_model* handle, const char* function) : model_(models().find(handle, function)) {
    if (model_->in_use.test_and_set(std::memory_order_acquire)) {
      fail(BS_BUSY, std::string(function) + ": bs_model: another call is using it; expected one at a time");
    }
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  ~Use() { model_->in_use.clear(std::memory_order_release); }
  ModelState& operator*() const { return *model_; }
  ModelState* operator->() const { return model_.get(); }

 private:
  std::shared_ptr<ModelState> model_;
};

void need_begun(const ModelState& model, const char* function) {
  if (!model.begun) {
    fail(BS_BAD_ORDER, std::string(function) + ": no picture has begun; expected bs_begin before");
  }
}

std::string name_of(const ModelState& model) { return std::string(model.entry->name); }

// The records of a stage can be asked for.
void need_records(const ModelState& model, const char* function) {
  need_begun(model, function);
  if (!model.entry->compared) {
    fail(BS_UNSUPPORTED, std::string(function) + ": engine " + name_of(model) +
                             " has no records; expected golden, model, timed, systemc or rtl");
  }
  if (model.untraced) {
    fail(BS_BAD_ORDER,
         std::string(function) +
             ": something was drawn without records; expected bs_trace(model, 1) before bs_begin");
  }
}

// Runs what draws. What it throws leaves a picture that is not whole.
template <class Draw>
void draw_whole(ModelState& model, const Draw& draw) {
  if (!model.tracing) model.untraced = true;
  try {
    draw(model.tracing ? &model.trace : nullptr);
  } catch (...) {
    model.begun = false;
    throw;
  }
}

// The next triangles have the caller's numbers.
void number_triangles(ModelState& model, std::uint64_t frame, std::uint64_t draw) {
  if (model.numbers.empty() || model.numbers.back().frame != frame || model.numbers.back().draw != draw) {
    model.numbers.push_back({model.triangles, frame, draw});
  }
  model.plane.reset();
}

void draw_triangles(ModelState& model, const bs_vertex* v, const std::int32_t* textures, std::size_t count,
                    std::uint64_t frame, std::uint64_t draw, const char* function) {
  need_begun(model, function);
  if (count == 0) return;
  need(v, (std::string(function) + ": v").c_str());
  const auto limit = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() - model.triangles);
  if (count > limit) {
    fail(BS_BAD_INPUT, std::string(function) + ": count: " + std::to_string(count) + "; expected at most " +
                           std::to_string(limit) + " triangles more in a picture");
  }
  std::vector<Triangle> triangles;
  triangles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    triangles.push_back(triangle_from(v, i, textures == nullptr ? -1 : textures[i], model.scene,
                                      model.views.now(), model.triangles + static_cast<std::int64_t>(i),
                                      function));
  }
  number_triangles(model, frame, draw);
  draw_whole(model, [&](Trace* trace) { model.engine->draw(triangles, model.triangles, trace); });
  model.triangles += static_cast<std::int64_t>(count);
}

void draw_scene(ModelState& model, const Scene& scene, std::size_t first, std::size_t count,
                std::uint64_t frame, std::uint64_t draw) {
  need_begun(model, "bs_draw_scene");
  const std::size_t all = scene.triangles.size();
  if (first > all || count > all - first) {
    fail(BS_BAD_INPUT, "bs_draw_scene: first, count: " + std::to_string(first) + ", " +
                           std::to_string(count) + "; expected a range of the scene's " +
                           std::to_string(all) + " triangles");
  }
  Views views = model.views;
  const std::span<const DrawCommand> commands = commands_of(scene, first, count);
  auto command = commands.begin();
  for (std::size_t i = first; i < first + count; ++i) {
    for (; command != commands.end() && command->before <= i; ++command) views.execute(*command);
    model::check_triangle(views.now(), model.scene.textures.size(), scene.triangles[i],
                          static_cast<std::int64_t>(i));
  }
  for (; command != commands.end(); ++command) views.execute(*command);
  number_triangles(model, frame, draw);
  draw_whole(model, [&](Trace* trace) {
    bitspan::draw_scene(*model.engine, scene, first, count, model.triangles, trace);
  });
  model.views = views;
  model.triangles += static_cast<std::int64_t>(count);
}

template <class Record>
Record record_from(const ModelState& model, const std::int64_t* values, std::size_t n) {
  constexpr RecordType type = record_type<Record>;
  if (n != fields<Record>.size()) {
    fail(BS_BAD_INPUT, "bs_row: n: " + std::to_string(n) + "; expected the " +
                           std::to_string(fields<Record>.size()) + " fields of " +
                           std::string(stage_of(type)));
  }
  check_registers(model.config, type, {values, n}, "bs_row");
  Record out;
  std::copy(values, values + n, reinterpret_cast<std::int64_t*>(&out));
  return out;
}

// The row, and which of the plane's it is.
std::pair<AnyRow, std::size_t> row_from(const ModelState& model, RecordType type, const std::int64_t* values,
                                        std::size_t n) {
  const bool planes = has_plane_rows(model.config.perspective);
  AnyRow row;
  if (type == RecordType::row && !planes) {
    const auto record = record_from<RowRecord>(model, values, n);
    check_pixels(record, model.views.now(), "bs_row");
    return {record, 0};
  }
  if (type == RecordType::plane_row && planes) {
    row = record_from<PlaneRowRecord>(model, values, n);
  } else if (type == RecordType::span) {
    const auto record = record_from<SpanRecord>(model, values, n);
    if (!planes) check_pixels(record, model.views.now(), "bs_row");
    row = record;
  } else {
    fail(BS_BAD_INPUT, "bs_row: stage: " + std::string(stage_of(type)) +
                           " delivers no row in this mode; expected " +
                           (planes ? "plane_walk.row, span_setup or setup" : "edge_walk or span_setup"));
  }
  if (!planes) return {row, 0};
  if (!model.plane) {
    fail(BS_BAD_ORDER, "bs_row: a row of constant depth has no triangle; expected a record of setup before");
  }
  return {row, row_of_plane(row, *model.plane, "bs_row")};
}

void draw_row(ModelState& model, RecordType type, const std::int64_t* values, std::size_t n,
              std::int32_t texture) {
  if (model.rows == nullptr) {
    fail(BS_UNSUPPORTED, "bs_row: engine " + name_of(model) + " takes no rows; expected golden or model");
  }
  check_texture(model.scene, texture, "bs_row");
  if (type == RecordType::setup && has_plane_rows(model.config.perspective)) {
    const auto record = record_from<SetupRecord>(model, values, n);
    check_setup(record, "bs_row");
    model.plane.reset();
    model.plane = model.rows->set_plane(record);
    return;
  }
  const auto row = row_from(model, type, values, n);
  draw_whole(model, [&](Trace* trace) { model.rows->draw_row(row.first, row.second, texture, trace); });
}

// The caller's function as the engine calls it.
StageHook hook_of(const ModelState& model, RecordType type) {
  const Override& own = model.overrides[static_cast<std::size_t>(type)];
  if (own.function == nullptr) return {};
  return [&config = model.config, own, type, before = std::vector<std::int64_t>()](
             std::span<const std::int64_t> in, std::span<std::int64_t> out) mutable {
    constexpr std::string_view function = "bs_stage_override";
    before.assign(out.begin(), out.end());
    if (own.function(own.user, in.data(), in.size(), out.data(), out.size()) != 0) {
      fail(BS_BAD_INPUT,
           std::string(function) + ": " + std::string(stage_of(type)) + ": the function refused; expected 0");
    }
    if (std::ranges::equal(before, out)) return;
    check_registers(config, type, out, function);
    check_identity(type, before, out, function);
    if (type == RecordType::setup) {
      SetupRecord record;
      std::ranges::copy(out, reinterpret_cast<std::int64_t*>(&record));
      check_setup(record, function);
    }
  };
}

std::string overridden_stages(const ModelState& model) {
  std::string out;
  for (const StageRow& row : stage_table) {
    if (model.overrides[static_cast<std::size_t>(row.type)].function == nullptr) continue;
    out.append(out.empty() ? "" : ", ").append(row.name);
  }
  return out;
}

template <class T>
bs_view plane_view(const std::vector<T>& plane, const Frame& frame, bs_element element, int channels) {
  bs_view view{};
  const auto width = static_cast<std::size_t>(frame.width);
  view.base = plane.data();
  view.rows = static_cast<std::size_t>(frame.height);
  view.columns = width;
  view.stride = width * sizeof(T) * static_cast<std::size_t>(channels);
  view.element = element;
  view.channels = channels;
  return view;
}

bs_view frame_view(ModelState& model, bs_plane plane) {
  const Frame& frame = model.engine->frame();
  switch (plane) {
    case BS_PLANE_COLOR:
      return plane_view(frame.color, frame, BS_U8, 4);
    case BS_PLANE_DEPTH:
      return plane_view(frame.depth, frame, BS_U32, 1);
    case BS_PLANE_U:
      return plane_view(frame.u, frame, BS_F64, 1);
    case BS_PLANE_V:
      return plane_view(frame.v, frame, BS_F64, 1);
    case BS_PLANE_TRIANGLE:
      return plane_view(frame.triangle, frame, BS_I32, 1);
    case BS_PLANE_STENCIL: {
      bs_view view = plane_view(frame.stencil, frame, BS_U8, 1);
      if (frame.stencil.empty()) view.rows = 0;
      return view;
    }
    case BS_PLANE_POSITION:
      // Views of an unchanged picture stay as they are.
      model.positions.resize(3 * frame.depth.size());
      std::ranges::copy(positions_of(model.config, with_view(model.views.now()), frame).points,
                        model.positions.begin());
      return plane_view(model.positions, frame, BS_F64, 3);
    default:
      fail(BS_BAD_INPUT, "bs_frame_view: plane: " + std::to_string(plane) + " is no plane; expected 0 to 6");
  }
}

constexpr std::size_t view_least = sizeof(bs_view);

std::shared_ptr<ModelState> open(const bs_config* config, const char* engine) {
  auto model = std::make_shared<ModelState>();
  model->config = copy_of(config, "bs_open");
  model->entry = &engine_entry(engine);
  check_config(model->config, model->config.name);
  if (!model->entry->runs(model->config)) {
    fail(BS_UNSUPPORTED, std::string("bs_open: engine: ") + engine + " needs " + model->entry->needs);
  }
  make_engine(*model);
  return model;
}

std::int64_t counter(const Counters& counters, std::string_view name) {
  std::optional<std::int64_t> value;
  std::string legal;
  for_each_counter([&](const CounterInfo& info, auto member) {
    if (info.name == name) value = static_cast<std::int64_t>(counters.*member);
    legal.append(legal.empty() ? "" : ", ").append(info.name);
  });
  if (!value) {
    fail(BS_BAD_INPUT, "bs_counter: name: '" + std::string(name) + "' is no counter; expected " + legal);
  }
  return *value;
}

std::string run_text(const ModelState& model) {
  std::string out = "engine " + name_of(model) + ", configuration " + model.config.name + " (" +
                    config_hash(model.config) + ")";
  if (model.overridden.empty()) return out;
  return out + ", overridden stages: " + model.overridden + "; not checked by golden";
}

}  // namespace

std::uintptr_t next_handle() {
  // Multiples of 16 that no object's address will be.
  static std::atomic<std::uintptr_t> next{16};
  return next.fetch_add(16);
}

void make_engine(ModelState& model) {
  model.overridden = overridden_stages(model);
  if (!model.overridden.empty()) {
    StageHooks hooks;
    for (std::size_t t = 0; t < hooks.size(); ++t) hooks[t] = hook_of(model, static_cast<RecordType>(t));
    model.engine = make_overridden_model(model.config, std::move(hooks));
  } else {
    model.engine = model.entry->make(model.config, {});
  }
  model.rows = dynamic_cast<RowEngine*>(model.engine.get());
  model.is_current = true;
}

}  // namespace bitspan::capi

using namespace bitspan;
using namespace bitspan::capi;

uint32_t bs_abi_version(void) { return BS_ABI_VERSION; }
const char* bs_version(void) { return BITSPAN_VERSION; }

// The names are literals, and so end with a zero.
const char* bs_stage_name(bs_stage stage) {
  return is_stage(stage) ? row_of(stage_types[static_cast<std::size_t>(stage)]).name.data() : nullptr;
}
const char* bs_engine_name(int i) {
  const auto all = engine_list();
  return i >= 0 && static_cast<std::size_t>(i) < all.size() ? all[static_cast<std::size_t>(i)].data()
                                                            : nullptr;
}
const char* bs_counter_name(int i) {
  const char* name = nullptr;
  int at = 0;
  for_each_counter([&](const CounterInfo& info, auto /*member*/) {
    if (at++ == i) name = info.name.data();
  });
  return name;
}

bs_status bs_open(bs_config* config, const char* engine, bs_model** out) {
  return call([&] {
    need(engine, "bs_open: engine");
    need(out, "bs_open: out");
    *out = models().add(open(config, engine));
  });
}

void bs_close(bs_model* model) { models().remove(model); }

bs_status bs_trace(bs_model* handle, int32_t on) {
  return call([&] {
    const Use model(handle, "bs_trace");
    if (on != 0 && on != 1) {
      fail(BS_BAD_INPUT, "bs_trace: on: " + std::to_string(on) + "; expected 0 or 1");
    }
    model->tracing = on == 1;
  });
}

bs_status bs_begin(bs_model* handle, const bs_scene_desc* scene) {
  return call([&] {
    const Use model(handle, "bs_begin");
    Scene next = scene_from(scene);
    model->begun = false;
    model->trace.clear();
    model->untraced = false;
    model->triangles = 0;
    model->numbers.clear();
    model->plane.reset();
    for (CheckState& check : model->checks) check = {};
    model->scene = std::move(next);
    model->views = Views(model->scene);
    if (!model->is_current) make_engine(*model);
    model->engine->begin(model->scene);
    model->begun = true;
  });
}

bs_status bs_triangle(bs_model* handle, const bs_vertex v[3], int32_t texture, uint64_t frame,
                      uint64_t draw) {
  return call([&] {
    const Use model(handle, "bs_triangle");
    draw_triangles(*model, v, &texture, 1, frame, draw, "bs_triangle");
  });
}

bs_status bs_draw(bs_model* handle, const bs_vertex* vertices, const int32_t* textures, size_t count,
                  uint64_t frame, uint64_t draw) {
  return call([&] {
    const Use model(handle, "bs_draw");
    draw_triangles(*model, vertices, textures, count, frame, draw, "bs_draw");
  });
}

bs_status bs_draw_scene(bs_model* handle, bs_scene* scene, size_t first, size_t count, uint64_t frame,
                        uint64_t draw) {
  return call([&] {
    const Use model(handle, "bs_draw_scene");
    draw_scene(*model, *scene_of(scene, "bs_draw_scene"), first, count, frame, draw);
  });
}

bs_status bs_command(bs_model* handle, const char* json) {
  return call([&] {
    const Use model(handle, "bs_command");
    need(json, "bs_command: json");
    need_begun(*model, "bs_command");
    const DrawCommand command = parse_command(json, "bs_command");
    if (!model->tracing) model->untraced = true;
    Views views = model->views;
    views.execute(command);
    // A view that does not fit the configuration leaves a picture that cannot go on.
    const bool other = views.now() != model->views.now();
    if (other) model->begun = false;
    model->engine->execute(command, model->triangles, model->tracing ? &model->trace : nullptr);
    model->begun = true;
    model->views = views;
  });
}

bs_status bs_row(bs_model* handle, bs_stage stage, const int64_t* record, size_t n, int32_t texture) {
  return call([&] {
    const Use model(handle, "bs_row");
    const RecordType type = type_of(stage, "bs_row");
    need(record, "bs_row: record");
    need_begun(*model, "bs_row");
    draw_row(*model, type, record, n, texture);
  });
}

bs_status bs_records(bs_model* handle, bs_stage stage, bs_view* out) {
  return call([&] {
    const Use model(handle, "bs_records");
    const RecordType type = type_of(stage, "bs_records");
    need_records(*model, "bs_records");
    const RecordView records = view_of(model->trace, type);
    bs_view view{};
    view.base = records.records == 0 ? nullptr : records.values;
    view.rows = records.records;
    view.columns = records.fields.size();
    view.stride = view.columns * sizeof(std::int64_t);
    view.element = BS_I64;
    view.channels = 1;
    write_struct(out, view, view_least, "bs_records: out");
  });
}

bs_status bs_clear_records(bs_model* handle) {
  return call([&] {
    const Use model(handle, "bs_clear_records");
    for (const StageRow& row : stage_table) {
      CheckState& check = model->checks[static_cast<std::size_t>(row.type)];
      check.forgotten += view_of(model->trace, row.type).records;
      check.checked = std::max(check.checked, check.forgotten);
    }
    model->trace.clear();
  });
}

bs_status bs_frame_view(bs_model* handle, bs_plane plane, bs_view* out) {
  return call([&] {
    const Use model(handle, "bs_frame_view");
    need_begun(*model, "bs_frame_view");
    write_struct(out, frame_view(*model, plane), view_least, "bs_frame_view: out");
  });
}

bs_status bs_counter(bs_model* handle, const char* name, int64_t* out) {
  return call([&] {
    const Use model(handle, "bs_counter");
    need(name, "bs_counter: name");
    need(out, "bs_counter: out");
    need_begun(*model, "bs_counter");
    *out = counter(model->engine->counters(), name);
  });
}

bs_status bs_check(bs_model* handle, bs_stage stage, const int64_t* dut, size_t n, bs_divergence* first) {
  return call([&] {
    const Use model(handle, "bs_check");
    const RecordType type = type_of(stage, "bs_check");
    constexpr std::size_t least = sizeof(bs_divergence);
    if (n != 0) need(dut, "bs_check: dut");
    if (first != nullptr) check_struct(first, least, "bs_check: first");
    need_records(*model, "bs_check");
    bs_divergence found{};
    const bool same = check_records(*model, type, dut, n, found);
    if (first != nullptr) write_struct(first, found, least, "bs_check: first");
    if (!same) fail(BS_DIFFERENT, text_of(found, *model));
  });
}

uint64_t bs_matched(bs_model* handle) {
  return call_or<uint64_t>(0, [&] { return Use(handle, "bs_matched")->matched; });
}

uint64_t bs_nontrivial(bs_model* handle) {
  return call_or<uint64_t>(0, [&] { return Use(handle, "bs_nontrivial")->nontrivial; });
}

uint64_t bs_unchecked(bs_model* handle, bs_stage stage) {
  return call_or<uint64_t>(0, [&] {
    const Use model(handle, "bs_unchecked");
    const RecordType type = type_of(stage, "bs_unchecked");
    const CheckState& check = model->checks[static_cast<std::size_t>(type)];
    return check.forgotten + view_of(model->trace, type).records - check.checked;
  });
}

bs_status bs_stage_override(bs_model* handle, bs_stage stage, bs_stage_fn function, void* user) {
  return call([&] {
    const Use model(handle, "bs_stage_override");
    const RecordType type = type_of(stage, "bs_stage_override");
    if (model->entry->name != "model") {
      fail(BS_UNSUPPORTED, "bs_stage_override: engine " + name_of(*model) + " has no such; expected model");
    }
    if (!may_be_hooked(type)) {
      fail(BS_UNSUPPORTED, "bs_stage_override: stage: " + std::string(stage_of(type)) +
                               " cannot be overridden; expected any but constants, state and plane_walk");
    }
    model->overrides[static_cast<std::size_t>(type)] = {function, user};
    model->is_current = false;
  });
}

const char* bs_run_text(bs_model* handle) {
  return call_or<const char*>(nullptr, [&] {
    const Use model(handle, "bs_run_text");
    model->run_text = run_text(*model);
    return model->run_text.c_str();
  });
}
