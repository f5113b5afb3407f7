#include "config/document/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/channel/channel_keys.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/bus_keys.hpp"
#include "config/sections/device_keys.hpp"
#include "config/sections/port.hpp"

namespace fieldcast::config {
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
  static const std::array<const RowTable*, 20> tables{
      &bridge_rows(),   &identity_rows(),    &standby_rows(),  &dds_rows(),
      &log_rows(),      &store_rows(),       &metrics_rows(),  &program_rows(),
      &engineer_rows(), &module_rows(),      &bus_rows(),      &port_rows(),
      &capture_rows(),  &bus_default_rows(), &device_rows(),   &channel_rows(),
      &limit_rows(),    &write_rows(),       &template_rows(), &template_default_rows()};
  return tables;
}

std::span<const Column> columns() {
  static const std::vector<Column> all = all_columns();
  return all;
}

std::string where_it_belongs(std::string_view key, const KeyTable& here) {
  // The search order: the most likely place of a misplaced key is first.
  const std::array<const RowTable*, 17> order{
      &bus_default_rows(), &port_rows(),   &channel_rows(), &device_rows(),   &bus_rows(),
      &limit_rows(),       &write_rows(),  &dds_rows(),     &store_rows(),    &bridge_rows(),
      &engineer_rows(),    &module_rows(), &metrics_rows(), &template_rows(), &identity_rows(),
      &standby_rows(),     &capture_rows()};
  for (const RowTable* table : order) {
    if (table != &here && std::ranges::find(table->keys, key) != table->keys.end())
      return fmt::format(" (it belongs in {})", table->what);
  }
  return {};
}

}  // namespace fieldcast::config
