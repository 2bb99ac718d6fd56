// SPDX-License-Identifier: Apache-2.0
#include "cli/config_schema.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <variant>

#include "config/keys.hpp"

namespace bitspan {
namespace {

using Json = nlohmann::ordered_json;

Json schema_of(const int* /*place*/, const Limits& limits) {
  if (limits.highest == 0) return {{"type", "integer"}};  // a format's field: its limits hang on the others
  if (!limits.power_of_two) {
    return {{"type", "integer"}, {"minimum", limits.lowest}, {"maximum", limits.highest}};
  }
  Json values = Json::array();
  for (std::int64_t v = 1; v <= limits.highest; v *= 2) {
    if (v >= limits.lowest) values.push_back(v);
  }
  return {{"enum", values}};
}
Json schema_of(const bool* /*place*/, const Limits& /*limits*/) { return {{"type", "boolean"}}; }
Json schema_of(const Choice& place, const Limits& /*limits*/) {
  Json names = Json::array();
  for (const std::string_view name : place.names) names.push_back(name);
  return {{"enum", names}};
}
Json any_of(Json a, Json b) { return {{"anyOf", Json::array({std::move(a), std::move(b)})}}; }
Json schema_of(const StartOffset* /*place*/, const Limits& /*limits*/) {
  return any_of({{"type", "number"}}, {{"const", "half_ulp"}});
}
Json schema_of(const Color* /*place*/, const Limits& /*limits*/) {
  const Json code{{"type", "integer"}, {"minimum", 0}, {"maximum", 255}};
  return any_of({{"const", "none"}}, {{"type", "array"}, {"items", code}, {"minItems", 3}, {"maxItems", 3}});
}
Json schema_of(const Rgba* /*place*/, const Limits& /*limits*/) {
  const Json code{{"type", "integer"}, {"minimum", 0}, {"maximum", 255}};
  return {{"type", "array"}, {"items", code}, {"minItems", 4}, {"maxItems", 4}};
}

Json table_schema() {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
}

Json schema_of(const Format* /*place*/, const Limits& /*limits*/) {
  Json out = table_schema();
  for (const FieldRow& field : field_rows()) {
    Format format;
    Json value = std::visit([](const auto& at) { return schema_of(at, Limits{}); }, field.place(format));
    value["description"] = std::string(field.text) + "; legal: " + std::string(field.legal);
    out["properties"][std::string(field.name)] = std::move(value);
    if (field.presence == Presence::always) out["required"].push_back(field.name);
  }
  return out;
}

// The table of that name, made where it is not there.
Json& table_in(Json& root, std::string_view path, bool required) {
  Json* at = &root;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    const std::string name(path.substr(0, dot));
    path.remove_prefix(dot == std::string_view::npos ? path.size() : dot + 1);
    if (!(*at)["properties"].contains(name)) (*at)["properties"][name] = table_schema();
    if (required) {
      Json& names = (*at)["required"];
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    at = &(*at)["properties"][name];
  }
  return *at;
}

}  // namespace

std::string config_schema() {
  static const Config any;
  Json root{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
            {"title", "A configuration of bitspan"}};
  root.update(table_schema());
  for (const Key& key : entries()) {
    const bool required = key.presence() == Presence::always;
    Json& table = table_in(root, key.table(), required);
    Json value =
        std::visit([&key](const auto& at) { return schema_of(at, key.row->limits); }, place(any, key));
    // The canonical text has 0 where the key is not used.
    if (key.presence() == Presence::where_used) value = any_of(std::move(value), {{"const", 0}});
    value["description"] = key.row->text;
    const std::string name(key.name());
    if (required) table["required"].push_back(name);
    table["properties"][name] = std::move(value);
  }
  return root.dump(2) + "\n";
}

}  // namespace bitspan
