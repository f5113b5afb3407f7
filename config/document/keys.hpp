// All keys of the format, by map. See config/keys/ for the rows.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace fieldcast::config {

struct KeyTable {
  std::string_view name;  // of the definition in the schema: "channel"
  std::string_view what;  // for faults: "a channel"
  std::span<const std::string_view> keys;
};

struct RowTable;

// Every map of the format, in the order of the documents.
[[nodiscard]] std::span<const RowTable* const> key_tables();

// A column of a channel list and its key: "write-min" for min of write.
struct Column {
  std::string_view name;
  std::string_view map;  // "limits", "write", or empty for the channel itself
  std::string_view key;
};
[[nodiscard]] std::span<const Column> columns();

// "(it belongs in 'defaults' of a bus)"; empty if there is no hint.
[[nodiscard]] std::string where_it_belongs(std::string_view key, const KeyTable& here);

}  // namespace fieldcast::config
