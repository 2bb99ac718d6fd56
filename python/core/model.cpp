// SPDX-License-Identifier: Apache-2.0
// Models, and NumPy's views of what they hold.
//
// A view points into the memory of a bs_model, which a Session owns. Each view shares the session, so it
// holds after its Model is gone. A session counts its views, and refuses what would move the memory below
// them. All members of a Session are used under Python's lock only.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "python/core/core.hpp"

namespace bitspan::python {
namespace {

// A function of the user's behind a stage.
struct Override {
  nb::object function;
  std::optional<nb::python_error> raised;
};

struct Session {
  std::string key;  // of those that are kept for later; else empty
  Owned<bs_model, bs_close> model;
  std::map<bs_stage, std::unique_ptr<Override>> overrides;
  std::vector<std::unique_ptr<Override>> replaced;  // may be called until the next begin
  std::size_t views = 0;
  bool busy = false;     // a call without Python's lock works on it
  bool stopped = false;  // by an interrupt, in the middle of a picture
};

// The last session that nobody uses any more, for the next one of the same key: fresh memory for the records
// of a picture takes several times as long as drawing them. It lives as long as the program.
Session* kept = nullptr;

// Keeps a session whose records take no more memory than this.
constexpr std::size_t kept_bytes = std::size_t{256} << 20;

bool worth_keeping(const Session& session) {
  if (session.key.empty() || session.stopped) return false;
  std::size_t bytes = 0;
  for (bs_stage stage = 0; bs_stage_name(stage) != nullptr; ++stage) {
    bs_view view{};
    view.size = sizeof view;
    if (bs_records(session.model.get(), stage, &view) != BS_OK) return false;
    bytes += view.rows * view.stride;
  }
  return bytes <= kept_bytes;
}

void end(Session* session) {
  if (worth_keeping(*session)) std::swap(session, kept);
  delete session;
}

std::shared_ptr<Session> open(const ConfigHandle& config, const std::string& engine, bool keep) {
  std::string key;
  if (keep) key = engine + " " + config.full().name + " " + bs_config_hash(config.get());
  if (keep && kept != nullptr && kept->key == key) {
    check(bs_trace(kept->model.get(), 1));
    return {std::exchange(kept, nullptr), end};
  }
  auto session = std::make_unique<Session>();
  check(bs_open(config.get(), engine.c_str(), session->model.out()));
  session->key = std::move(key);
  return {session.release(), end};
}

enum class Access : std::uint8_t { read, change };

// A call on a session, until it ends. Throws StateError where it may not be.
class Use {
 public:
  Use(const std::shared_ptr<Session>& session, Access access, const char* what) : session_(session) {
    const std::string call = std::string("bitspan.Model.") + what + ": ";
    if (session == nullptr) throw StateError(call + "the model is closed; expected an open one");
    if (session->busy) throw StateError(call + "another call is using the model; expected one at a time");
    if (access == Access::change && session->views != 0) {
      throw StateError(
          call + std::to_string(session->views) +
          " arrays show the model's memory, which the call would change; expected that they are deleted, or "
          "were copied, or a new Model");
    }
    if (session->stopped && std::string_view(what) != "begin" && std::string_view(what) != "trace") {
      throw StateError(call + "the picture was interrupted; expected begin");
    }
    session_->busy = true;
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  ~Use() { session_->busy = false; }
  bs_model* get() const { return session_->model.get(); }
  Session* operator->() const { return session_.get(); }

 private:
  std::shared_ptr<Session> session_;
};

// Counts as a view for as long as it lives.
struct Lease {
  explicit Lease(std::shared_ptr<Session> s) : session(std::move(s)) { ++session->views; }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  ~Lease() { --session->views; }
  std::shared_ptr<Session> session;
};

nb::dlpack::dtype type_of(bs_element element) {
  switch (element) {
    case BS_U8:
      return nb::dtype<std::uint8_t>();
    case BS_U32:
      return nb::dtype<std::uint32_t>();
    case BS_I32:
      return nb::dtype<std::int32_t>();
    case BS_F64:
      return nb::dtype<double>();
    default:
      return nb::dtype<std::int64_t>();
  }
}

// A read-only array of the view's memory: (rows, columns), or (rows, columns, channels).
nb::object array_of(const bs_view& view, const std::shared_ptr<Session>& session) {
  static const std::int64_t none = 0;
  const std::array<std::size_t, 3> shape{view.rows, view.columns, static_cast<std::size_t>(view.channels)};
  nb::capsule owner(new Lease(session), [](void* lease) noexcept { delete static_cast<Lease*>(lease); });
  return nb::cast(nb::ndarray<nb::numpy, nb::ro>(view.base == nullptr ? &none : view.base,
                                                 view.channels > 1 ? 3 : 2, shape.data(), owner, nullptr,
                                                 type_of(view.element)));
}

// How many triangles from `first` on are drawn before a look at signals: as many as have about a million
// pixels in their boxes.
std::size_t batch_from(const SceneHandle& scene, std::size_t first) {
  constexpr double pixels = 1 << 20;
  constexpr std::size_t most = 1 << 16;
  const double width = scene.desc().width;
  const double height = scene.desc().height;
  double sum = 0;
  std::size_t i = first;
  for (; i < scene.count() && i - first < most && sum < pixels; ++i) {
    const bs_vertex* const v = scene.vertices() + 3 * i;
    const auto [x0, x1] = std::minmax({v[0].x, v[1].x, v[2].x});
    const auto [y0, y1] = std::minmax({v[0].y, v[1].y, v[2].y});
    sum += std::max(0.0, std::min(x1, width) - std::max(x0, 0.0)) *
           std::max(0.0, std::min(y1, height) - std::max(y0, 0.0));
  }
  return i - first;
}

// Calls the user's function with the record that feeds the stage, and with the stage's, which it may change.
// The arrays hold for the call alone, so the function gets copies.
std::int32_t call_override(void* user, const std::int64_t* in, std::size_t n_in, std::int64_t* out,
                           std::size_t n_out) {
  const nb::gil_scoped_acquire locked;
  auto& own = *static_cast<Override*>(user);
  try {
    nb::list before;
    for (std::size_t i = 0; i < n_in; ++i) before.append(in[i]);
    nb::list made;
    for (std::size_t i = 0; i < n_out; ++i) made.append(out[i]);
    const auto result = nb::cast<std::vector<std::int64_t>>(own.function(nb::tuple(before), made));
    if (result.size() != n_out) throw std::length_error("");
    std::ranges::copy(result, out);
    return 0;
  } catch (nb::python_error& error) {
    own.raised.emplace(error);
  } catch (const std::exception&) {
    PyErr_SetString(PyExc_TypeError,
                    "bitspan.Model.override: the function returned no record; expected its fields");
    own.raised.emplace();
  }
  return 1;
}

// As check(); what a function of the user's has raised comes first.
void check_draw(bs_status status, Session& session) {
  for (auto& [stage, own] : session.overrides) {
    if (!own->raised) continue;
    const nb::python_error raised = std::move(*own->raised);
    own->raised.reset();
    throw nb::python_error(raised);
  }
  check(status);
}

class Model {
 public:
  // keep: whether the session may be one that was used before, and may be used again. Its counts of checks go
  // on.
  Model(const ConfigHandle& config, const std::string& engine, bool keep)
      : session_(open(config, engine, keep)), engine_(engine) {}

  void close() { session_.reset(); }

  void trace(bool on) {
    const Use use(session_, Access::read, "trace");
    check(bs_trace(use.get(), on ? 1 : 0));
  }

  void begin(const SceneHandle& scene) {
    const Use use(session_, Access::change, "begin");
    {
      const nb::gil_scoped_release unlocked;
      check(bs_begin(use.get(), &scene.desc()));
    }
    use->stopped = false;
    use->replaced.clear();
  }

  void draw(const SceneHandle& scene, std::uint64_t frame, std::uint64_t draw) {
    const Use use(session_, Access::change, "draw");
    // The clocks of a whole picture need all of its triangles at once.
    const bool whole = engine_ == "timed";
    // A scene without triangles may have commands.
    std::size_t at = 0;
    do {
      const std::size_t n = whole ? scene.count() : batch_from(scene, at);
      bs_status status = BS_OK;
      {
        const nb::gil_scoped_release unlocked;
        status = scene.draw(use.get(), at, n, frame, draw);
      }
      check_draw(status, *use.operator->());
      at += n;
      if (at < scene.count() && PyErr_CheckSignals() != 0) {
        use->stopped = true;
        throw nb::python_error();
      }
    } while (at < scene.count());
  }

  void command(const std::string& json) {
    const Use use(session_, Access::change, "command");
    check(bs_command(use.get(), json.c_str()));
  }

  void row(const std::string& stage, const Row& record, std::int32_t texture) {
    const bs_stage number = stage_of(stage);
    const Use use(session_, Access::change, "row");
    bs_status status = BS_OK;
    {
      const nb::gil_scoped_release unlocked;
      status = bs_row(use.get(), number, record.data(), record.shape(0), texture);
    }
    check_draw(status, *use.operator->());
  }

  void override_stage(const std::string& stage, nb::object function) {
    const bs_stage number = stage_of(stage);
    const Use use(session_, Access::read, "override");
    if (function.is_none()) {
      check(bs_stage_override(use.get(), number, nullptr, nullptr));
      return;
    }
    auto own = std::make_unique<Override>(Override{std::move(function), {}});
    check(bs_stage_override(use.get(), number, &call_override, own.get()));
    // The one before is called no more after the next begin.
    use->overrides[number].swap(own);
    if (own != nullptr) use->replaced.push_back(std::move(own));
  }

  nb::object records(const std::string& stage) {
    bs_view view{};
    view.size = sizeof view;
    {
      const bs_stage number = stage_of(stage);
      const Use use(session_, Access::read, "records");
      check(bs_records(use.get(), number, &view));
    }
    return array_of(view, session_);
  }

  nb::object plane(bs_plane plane) {
    bs_view view{};
    view.size = sizeof view;
    {
      const Use use(session_, Access::read, "plane");
      check(bs_frame_view(use.get(), plane, &view));
    }
    return array_of(view, session_);
  }

  void clear_records() {
    const Use use(session_, Access::change, "clear_records");
    check(bs_clear_records(use.get()));
  }

  std::int64_t counter(const std::string& name) {
    const Use use(session_, Access::read, "counter");
    std::int64_t out = 0;
    check(bs_counter(use.get(), name.c_str(), &out));
    return out;
  }

  // None, or the first difference as a dictionary.
  nb::object check_records(const std::string& stage, const Table& records) {
    const bs_stage number = stage_of(stage);
    const Use use(session_, Access::read, "check");
    const std::size_t columns = columns_of(use.get(), number);
    if (records.shape(1) != columns) {
      throw InputError("bitspan.Model.check: records: has " + std::to_string(records.shape(1)) +
                       " columns; expected the " + std::to_string(columns) + " fields of " + stage);
    }
    bs_divergence d{};
    d.size = sizeof d;
    bs_status status = BS_OK;
    {
      const nb::gil_scoped_release unlocked;
      status = bs_check(use.get(), number, records.data(), records.shape(0), &d);
    }
    if (status != BS_DIFFERENT) {
      check(status);
      return nb::none();
    }
    nb::dict out;
    out["kind"] = d.kind == BS_DIVERGENCE_EXTRA ? "extra" : "value";
    out["stage"] = stage;
    out["record"] = d.record;
    out["triangle"] = d.triangle;
    out["x"] = d.x;
    out["y"] = d.y;
    out["frame"] = d.frame;
    out["draw"] = d.draw;
    out["field"] = d.field_name == nullptr ? nb::none() : nb::object(nb::str(d.field_name));
    out["expected"] = d.expected;
    out["actual"] = d.actual;
    out["expected_value"] = d.expected_value;
    out["actual_value"] = d.actual_value;
    out["differences"] = d.differences;
    out["text"] = bs_last_error();
    return out;
  }

  std::uint64_t matched() { return bs_matched(Use(session_, Access::read, "matched").get()); }
  std::uint64_t nontrivial() { return bs_nontrivial(Use(session_, Access::read, "nontrivial").get()); }
  std::uint64_t unchecked(const std::string& stage) {
    const bs_stage number = stage_of(stage);
    return bs_unchecked(Use(session_, Access::read, "unchecked").get(), number);
  }
  std::string text() { return bs_run_text(Use(session_, Access::read, "text").get()); }
  std::size_t views() const { return session_ == nullptr ? 0 : session_->views; }
  bool is_open() const { return session_ != nullptr; }

  // For Python's collector: a function of the user's often knows the model that it is behind.
  int traverse(visitproc visit, void* arg) const {
    if (session_ == nullptr) return 0;
    for (const auto& [stage, own] : session_->overrides) Py_VISIT(own->function.ptr());
    return 0;
  }
  void clear() {
    if (session_ == nullptr) return;
    for (auto& [stage, own] : session_->overrides) own->function.reset();
  }

 private:
  static std::size_t columns_of(bs_model* model, bs_stage stage) {
    bs_view view{};
    view.size = sizeof view;
    check(bs_records(model, stage, &view));
    return view.columns;
  }

  std::shared_ptr<Session> session_;
  std::string engine_;
};

int traverse_model(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  return nb::inst_ready(self) ? nb::inst_ptr<Model>(self)->traverse(visit, arg) : 0;
}
int clear_model(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<Model>(self)->clear();
  return 0;
}
PyType_Slot model_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&traverse_model)},
                             {Py_tp_clear, reinterpret_cast<void*>(&clear_model)},
                             {0, nullptr}};

}  // namespace

void bind_model(nb::module_& m) {
  nb::class_<Model>(m, "Model", nb::type_slots(model_slots))
      .def(nb::init<const ConfigHandle&, const std::string&, bool>(), nb::arg("config"), nb::arg("engine"),
           nb::arg("keep"))
      .def("close", &Model::close)
      .def("trace", &Model::trace, nb::arg("on"))
      .def("begin", &Model::begin, nb::arg("scene"))
      .def("draw", &Model::draw, nb::arg("scene"), nb::arg("frame"), nb::arg("draw"))
      .def("command", &Model::command, nb::arg("json"))
      .def("row", &Model::row, nb::arg("stage"), nb::arg("record"), nb::arg("texture"))
      .def("records", &Model::records, nb::arg("stage"),
           nb::sig("def records(self, stage: str) -> numpy.typing.NDArray[numpy.int64]"))
      .def("plane", &Model::plane, nb::arg("plane"),
           nb::sig("def plane(self, plane: int) -> numpy.typing.NDArray[typing.Any]"))
      .def("override", &Model::override_stage, nb::arg("stage"), nb::arg("function").none())
      .def("clear_records", &Model::clear_records)
      .def("counter", &Model::counter, nb::arg("name"))
      .def("check", &Model::check_records, nb::arg("stage"), nb::arg("records"),
           nb::sig("def check(self, stage: str, records: numpy.typing.NDArray[numpy.int64]) -> dict[str, "
                   "typing.Any] | None"))
      .def_prop_ro("matched", &Model::matched)
      .def_prop_ro("nontrivial", &Model::nontrivial)
      .def("unchecked", &Model::unchecked, nb::arg("stage"))
      .def_prop_ro("text", &Model::text)
      .def_prop_ro("views", &Model::views)
      .def_prop_ro("is_open", &Model::is_open);
}

}  // namespace bitspan::python
