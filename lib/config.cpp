// SPDX-License-Identifier: Apache-2.0
#include "lib/config.hpp"

#include <utility>

#include "config/keys.hpp"
#include "config/store.hpp"
#include "engine/records.hpp"
#include "lib/handles.hpp"
#include "lib/stages.hpp"
#include "lib/structs.hpp"
#include "report/describe.hpp"

namespace bitspan::capi {
namespace {

// Never destroyed: functions may be called while the program ends.
Handles<bs_config, ConfigState>& configs() {
  static auto* const all = new Handles<bs_config, ConfigState>("bs_config");
  return *all;
}

void set(Config& config, const std::string& path, std::string_view value) {
  const Key* const key = find_key(path);
  if (key == nullptr) {
    throw InputError(config.name + ": " + path +
                     ": is no key of a configuration; expected one of docs/configuration.md");
  }
  Config changed = config;
  if (const auto fault = set_value(changed, *key, value_in(value))) {
    throw InputError(config.name + ": " + path + ": " + *fault);
  }
  config = std::move(changed);
}

}  // namespace

bs_config* add(Config config) {
  auto state = std::make_shared<ConfigState>();
  state->config = std::move(config);
  return configs().add(std::move(state));
}

Config copy_of(const bs_config* handle, const char* function) {
  const auto state = configs().find(handle, function);
  const std::lock_guard lock(state->mutex);
  return state->config;
}

}  // namespace bitspan::capi

using namespace bitspan;
using namespace bitspan::capi;

bs_status bs_config_load(const char* name_or_path, bs_config** out) {
  return call([&] {
    need(name_or_path, "bs_config_load: name_or_path");
    need(out, "bs_config_load: out");
    *out = add(find_config(name_or_path));
  });
}

bs_status bs_config_parse(const char* toml, bs_config** out) {
  return call([&] {
    need(toml, "bs_config_parse: toml");
    need(out, "bs_config_parse: out");
    *out = add(parse_config(toml, "text"));
  });
}

bs_status bs_config_set(bs_config* config, const char* path, const char* value) {
  return call([&] {
    const auto state = configs().find(config, "bs_config_set");
    need(path, "bs_config_set: path");
    need(value, "bs_config_set: value");
    const std::lock_guard lock(state->mutex);
    set(state->config, path, value);
  });
}

const char* bs_config_hash(bs_config* config) {
  return call_or<const char*>(nullptr, [&] {
    const auto state = configs().find(config, "bs_config_hash");
    const std::lock_guard lock(state->mutex);
    state->hash = config_hash(state->config);
    return state->hash.c_str();
  });
}

const char* bs_config_text(bs_config* config) {
  return call_or<const char*>(nullptr, [&] {
    const auto state = configs().find(config, "bs_config_text");
    const std::lock_guard lock(state->mutex);
    state->text = to_toml(state->config);
    return state->text.c_str();
  });
}

void bs_config_free(bs_config* config) { configs().remove(config); }

bs_status bs_field(bs_config* config, bs_stage stage, int i, bs_field_info* out) {
  return call([&] {
    const Config c = copy_of(config, "bs_field");
    const RecordType type = type_of(stage, "bs_field");
    const auto all = fields_of(type);
    if (i < 0 || static_cast<std::size_t>(i) >= all.size()) {
      fail(BS_BAD_INPUT, "bs_field: i: " + std::to_string(i) + " is no field of " +
                             std::string(stage_of(type)) + "; expected 0 to " +
                             std::to_string(all.size() - 1));
    }
    const Field& field = all[static_cast<std::size_t>(i)];
    const std::optional<Format> format = format_of(field, c);
    bs_field_info info{};
    // The names are literals, and so end with a zero.
    info.name = field.name.data();
    info.unit = unit_of(field, c).data();
    if (format) {
      info.word = format->word;
      info.fraction = format->fraction();
      info.is_signed = format->is_signed ? 1 : 0;
    }
    write_struct(out, info, BITSPAN_THROUGH(bs_field_info, name), "bs_field: out");
  });
}
