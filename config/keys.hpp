// Every key of the format, by the map that it stands in. The rows themselves are in config/keys/.
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

// Columns of a channel list and the key that each fills, "write-min" for min of write.
struct Column {
  std::string_view name;
  std::string_view map;  // "limits", "write", or nothing for the channel itself
  std::string_view key;
};
[[nodiscard]] std::span<const Column> columns();

// "unknown key 'timeout' in a bus (it belongs in 'defaults' of a bus)": the part in brackets, or
// nothing.
[[nodiscard]] std::string where_it_belongs(std::string_view key, const KeyTable& here);

}  // namespace fieldcast::config
