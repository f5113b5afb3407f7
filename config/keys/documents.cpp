#include "config/keys/documents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/channel/channel_keys.hpp"
#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/bus_keys.hpp"
#include "config/sections/gateway.hpp"
#include "config/sections/port.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

namespace {

constexpr std::string_view kBegin = "<!-- keys: made from config/keys/, see below -->\n";
constexpr std::string_view kEnd = "<!-- end of keys -->\n";

std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '`') continue;
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 32);
  return text;
}

// Without references to other parts of the README.
std::string description_of(const Key& key) {
  std::string text = capital(key.text);
  for (const std::string_view pointer : {", see below", "See below"}) {
    if (const auto at = text.find(pointer); at != text.npos) text.erase(at, pointer.size());
  }
  if (!key.fallback.empty() && !key.fallback.starts_with(kNeeded))
    text += (text.empty() ? "Default " : ". Default ") + key.fallback;
  return text.empty() ? text : text + '.';
}

// "oil": { the rule, "description": "text." }.
std::string property(const Key& key) {
  std::string rule = key.schema;
  if (const auto text = description_of(key); !text.empty()) {
    rule.resize(rule.find_last_not_of(" }") == rule.npos ? 0 : rule.rfind(" }"));
    rule += fmt::format(", \"description\": {} }}", json_string(text));
  }
  return fmt::format("        \"{}\": {}", key.name, rule);
}

std::string quoted_list(const std::vector<std::string_view>& names) {
  std::string text;
  for (const auto name : names) {
    text += text.empty() ? "\"" : ", \"";
    text.append(name).append("\"");
  }
  return '[' + text + ']';
}

std::string definition(const RowTable& table) {
  std::string out = fmt::format("    \"{}\": {{\n      \"type\": \"object\",\n", table.name);
  out += "      \"additionalProperties\": false,\n";
  std::vector<std::string_view> needed;
  for (const Key& key : table.rows) {
    if (key.fallback == kNeeded) needed.push_back(key.name);
  }
  if (!needed.empty()) out += fmt::format("      \"required\": {},\n", quoted_list(needed));
  if (!table.one_of.empty()) {
    std::string all;
    for (const auto key : table.one_of) {
      all += all.empty() ? "" : ", ";
      all += fmt::format("{{ \"required\": [\"{}\"] }}", key);
    }
    out += fmt::format("      \"oneOf\": [{}],\n", all);
  }
  if (!table.text.empty())
    out += fmt::format("      \"description\": {},\n", json_string(table.text));
  out += "      \"properties\": {\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    out += property(table.rows[i]) + (i + 1 < table.rows.size() ? ",\n" : "\n");
  return out + "      }\n    },\n";
}

std::string common_definitions() {
  std::vector<std::string_view> names;
  for (const ProtocolEntry& entry : protocols()) names.push_back(entry.name);
  return R"(    "channels": {
      "anyOf": [
        { "type": "array", "items": { "$ref": "#/$defs/channel" } },
        { "type": "string", "minLength": 1, "description": "A CSV file, relative to this file." }
      ]
    },
    "options": {
      "type": "object",
      "maxProperties": )" +
         std::to_string(kMaxOptions) +
         R"(,
      "additionalProperties": { "type": ["string", "number", "boolean"] }
    },
    "allow": { "type": "array", "items": { "enum": ["raw-read", "raw-write"] } },
    "protocol": {
      "description": "One that is built in, or NAME for a declaration: protocols/NAME.yaml beside )"
         R"(this file, or one that comes with Fieldcast.",
      "anyOf": [
        { "enum": )" +
         quoted_list(names) + R"( },
        { "$ref": "#/$defs/word" }
      ]
    },
    "word": { "type": ["string", "number", "boolean"], "pattern": "^[A-Za-z0-9_.-]{1,64}$" },
    "duration": { "type": "string", "pattern": "^[0-9]+(\\.[0-9]+)?(us|ms|s|m|min|h|d)$" }
)";
}

// "A bus", "`dds`".
std::string title_of(const RowTable& table) {
  std::string title(table.what);
  std::ranges::replace(title, '\'', '`');
  return capital(std::move(title));
}

std::string value_of(const Key& key) {
  if (key.form.empty() || key.text.empty()) return key.form + key.text;
  return fmt::format("{}; {}", key.form, key.text);
}

std::string readme_table(const RowTable& table) {
  std::string rows;
  bool below = false;
  for (const Key& key : table.rows) {
    below |= key.from_below;
    if (key.from_below) continue;
    rows += fmt::format("| `{}`{} | {} | {} |\n", key.name, key.flows_down ? " ●" : "",
                        value_of(key), key.fallback);
  }
  std::string out = fmt::format("**{}**", title_of(table));
  if (!table.one_of.empty()) {
    std::string all;
    for (const auto key : table.one_of)
      all += (all.empty() ? ": with one of `" : "`, `") + std::string(key);
    out += all + '`';
  }
  out += "\n\n";
  if (!table.text.empty()) out += table.text + "\n\n";
  if (!rows.empty())
    out += fmt::format("| key | value | default |\n| --- | --- | --- |\n{}\n", rows);
  if (below) out += rows.empty() ? "Every ● below.\n\n" : "and every ● of what it holds.\n\n";
  return out;
}

}  // namespace

std::string schema_text() {
  std::string out = R"({
  "$schema": "https://json-schema.org/draft/2020-12/schema",
  "title": "Fieldcast configuration",
  "description": "Buses, devices and channels of one bridge. config/README.md explains every key.",
  "$ref": "#/$defs/bridge",
  "$defs": {
)";
  for (const RowTable* table : key_tables()) out += definition(*table);
  return fmt::format("{}{}  }}\n}}\n", out, common_definitions());
}

std::string with_key_tables(const std::string& readme) {
  const auto begin = readme.find(kBegin), end = readme.find(kEnd);
  if (begin == readme.npos || end == readme.npos || end < begin) return readme;
  std::string tables;
  for (const RowTable* table : key_tables()) tables += readme_table(*table);
  return readme.substr(0, begin + kBegin.size()) + '\n' + tables + readme.substr(end);
}

namespace {

void append_columns(const RowTable& table, std::string_view map, std::vector<Column>& all) {
  for (const Key& row : table.rows)
    all.push_back({row.column.empty() ? row.name : std::string_view(row.column), map, row.name});
}

std::vector<Column> all_columns() {
  const std::array<const RowTable*, 2> maps{&limit_rows(), &write_rows()};
  std::vector<Column> all;
  append_columns(channel_rows(), "", all);
  std::erase_if(all, [&](const Column& column) {
    return std::ranges::find(maps, column.name, &KeyTable::name) != maps.end();
  });
  for (const RowTable* map : maps) append_columns(*map, map->name, all);
  return all;
}

}  // namespace

std::span<const RowTable* const> key_tables() {
  static const std::array<const RowTable*, 24> tables{
      &bridge_rows(),      &identity_rows(),      &standby_rows(),          &dds_rows(),
      &log_rows(),         &store_rows(),         &metrics_rows(),          &program_rows(),
      &engineer_rows(),    &engineer_port_rows(), &module_rows(),           &bus_rows(),
      &port_rows(),        &capture_rows(),       &gateway_rows(),          &gateway_row_rows(),
      &bus_default_rows(), &device_rows(),        &channel_rows(),          &limit_rows(),
      &write_rows(),       &template_rows(),      &template_default_rows(), &configure_rows()};
  return tables;
}

std::span<const Column> columns() {
  static const std::vector<Column> all = all_columns();
  return all;
}

std::string where_it_belongs(std::string_view key, const KeyTable& here) {
  // The search order: the most likely place of a misplaced key is first.
  const std::array<const RowTable*, 21> order{
      &bus_default_rows(), &port_rows(),     &channel_rows(),     &device_rows(),
      &bus_rows(),         &limit_rows(),    &write_rows(),       &dds_rows(),
      &store_rows(),       &bridge_rows(),   &engineer_rows(),    &module_rows(),
      &metrics_rows(),     &template_rows(), &identity_rows(),    &standby_rows(),
      &capture_rows(),     &gateway_rows(),  &gateway_row_rows(), &engineer_port_rows(),
      &configure_rows()};
  for (const RowTable* table : order) {
    if (table != &here && std::ranges::find(table->keys, key) != table->keys.end())
      return fmt::format(" (it belongs in {})", table->what);
  }
  return {};
}

}  // namespace fieldcast::config
