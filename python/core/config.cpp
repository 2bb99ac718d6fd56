// SPDX-License-Identifier: Apache-2.0
#include "lib/config.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/core/core.hpp"
#include "study/keys.hpp"

namespace bitspan::python {

ConfigHandle ConfigHandle::load(const std::string& name_or_path) {
  ConfigHandle out;
  check(bs_config_load(name_or_path.c_str(), out.config_.out()));
  return out;
}

ConfigHandle ConfigHandle::parse(const std::string& toml) {
  ConfigHandle out;
  check(bs_config_parse(toml.c_str(), out.config_.out()));
  return out;
}

ConfigHandle ConfigHandle::with(const std::vector<std::pair<std::string, std::string>>& settings) const {
  std::vector<KeySetting> keys;
  for (const auto& [path, value] : settings) keys.push_back({path, value_in(value)});
  ConfigHandle out;
  *out.config_.out() = capi::add(with_keys(full(), keys));
  return out;
}

Config ConfigHandle::full() const { return capi::copy_of(config_.get(), "bitspan.Config"); }

bs_stage stage_of(const std::string& name) {
  std::string legal;
  for (bs_stage s = 0; bs_stage_name(s) != nullptr; ++s) {
    if (name == bs_stage_name(s)) return s;
    legal.append(legal.empty() ? "" : ", ").append(bs_stage_name(s));
  }
  throw InputError("'" + name + "' is no stage; expected " + legal);
}

namespace {

nb::list fields(const ConfigHandle& config, const std::string& stage) {
  const bs_stage number = stage_of(stage);
  nb::list out;
  bs_field_info info{};
  info.size = sizeof info;
  for (int i = 0; bs_field(config.get(), number, i, &info) == BS_OK; ++i) {
    out.append(nb::make_tuple(info.name, info.word, info.fraction, info.is_signed != 0, info.unit));
  }
  return out;
}

}  // namespace

void bind_config(nb::module_& m) {
  nb::class_<ConfigHandle>(m, "ConfigHandle")
      .def_static("load", &ConfigHandle::load, nb::arg("name_or_path"))
      .def_static("parse", &ConfigHandle::parse, nb::arg("toml"))
      .def("with_settings", &ConfigHandle::with, nb::arg("settings"),
           "Another configuration, with keys set to values as in TOML.")
      .def_prop_ro("name", [](const ConfigHandle& c) { return c.full().name; })
      .def_prop_ro("hash", [](const ConfigHandle& c) { return std::string(bs_config_hash(c.get())); })
      .def_prop_ro("text", [](const ConfigHandle& c) { return std::string(bs_config_text(c.get())); })
      .def("fields", &fields, nb::arg("stage"), "(name, word, fraction, signed, unit) of each field.");
}

}  // namespace bitspan::python
