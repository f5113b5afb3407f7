// All keys of the format, by map. See config/keys/ for the rows.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "config/document/document.hpp"

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

// Reads the keys of one map by name; the constructor adds faults for unknown keys. Borrows node and
// fault list. Aborts at the end if a key of the table was never read, which is a bug.
class MapReader {
 public:
  MapReader(const Node& node, const KeyTable& table, FaultList& faults);
  ~MapReader();
  MapReader(const MapReader&) = delete;
  MapReader& operator=(const MapReader&) = delete;

  // Null if absent, or without a value (a fault). REQUIRES: the key is in the table.
  const Node* find(std::string_view key);
  // As find(), but absence is a fault; `allowed`: the expected value.
  const Node* require(std::string_view key, std::string_view allowed);

  // Sets `target` by a rule of scalars.hpp; returns false if the key is absent or invalid.
  template <typename Target, typename Rule>
  bool read(std::string_view key, Target& target, const Rule& rule) {
    const Node* value = find(key);
    return value != nullptr && put(*value, key, target, rule);
  }
  template <typename Target, typename Rule>
  bool read_required(std::string_view key, Target& target, const Rule& rule,
                     std::string_view allowed) {
    const Node* value = require(key, allowed);
    return value != nullptr && put(*value, key, target, rule);
  }

  [[nodiscard]] bool is_map() const { return node_.kind == Kind::kMap; }
  [[nodiscard]] bool has(std::string_view key) const;
  // Also true for a probable misspelling, so that the key is not reported as missing too.
  [[nodiscard]] bool has_or_means(std::string_view key) const;
  // Position of the value, or of the map if the key is absent.
  [[nodiscard]] Position position_of(std::string_view key) const;
  [[nodiscard]] const Position& position() const { return node_.position; }
  [[nodiscard]] FaultList& faults() { return faults_; }
  // Adds a fault at position_of(key).
  void fault(std::string_view key, std::string_view what, std::string_view allowed = {},
             std::string_view suggestion = {}) {
    faults_.add(position_of(key), what, allowed, suggestion);
  }

 private:
  template <typename Target, typename Rule>
  bool put(const Node& value, std::string_view key, Target& target, const Rule& rule) {
    auto result = rule(value, key, faults_);
    if (!result) return false;
    if constexpr (requires { target = std::move(*result); } && !std::is_arithmetic_v<Target>) {
      target = std::move(*result);
    } else {
      target = static_cast<Target>(*result);  // the rule's limits fit the target
    }
    return true;
  }
  [[nodiscard]] const Node::Entry* entry(std::string_view key) const;

  const Node& node_;
  const KeyTable& table_;
  FaultList& faults_;
  std::vector<bool> read_;          // by the index of the key in the table
  std::vector<std::string> meant_;  // probable meanings of unknown keys
};

// One key of the format: name, rule, default and description. Parser, messages, JSON Schema and
// config/README.md use these rows. Constant once made; any thread.
inline constexpr std::string_view kNeeded = "needed";  // default of a required key
inline constexpr bool kFlowsDown = true;               // see Key::flows_down

struct Key {
  std::string_view name;
  std::string fallback{};   // human-readable default; kNeeded: required
  std::string text{};       // description in the schema and the README
  bool flows_down = false;  // also allowed at higher levels, as a default
  std::string example{};    // for the fault of a missing key; empty: `text`
  std::string column{};     // of a channel list; empty: the key's name
  std::string schema{};     // of its value, as JSON; empty: from its rule
  std::string form{};       // human-readable form of its value; empty: from its rule
  bool from_below = false;  // described in the table of the lower level
};

// A row with its reader; without one, other code reads the key by name.
template <typename Owner>
struct Field {
  Key key;
  std::function<void(MapReader& map, Owner& owner)> read{};
};

// `access(owner)`: destination of the value, a pointer to a member or a function.
template <typename Owner, typename Access, typename Rule>
[[nodiscard]] Field<Owner> field(Key key, Access access, Rule rule) {
  if (key.schema.empty()) key.schema = rule.schema();
  if (key.form.empty()) key.form = rule.form();
  const bool needed = key.fallback == kNeeded;
  const std::string_view name = key.name;
  std::string allowed = key.example.empty() ? key.text : key.example;
  auto read = [=](MapReader& map, Owner& owner) {
    if (needed)
      map.read_required(name, std::invoke(access, owner), rule, allowed);
    else
      map.read(name, std::invoke(access, owner), rule);
  };
  return {std::move(key), std::move(read)};
}

template <typename Owner, typename T, typename Rule>
[[nodiscard]] Field<Owner> field(Key key, T Owner::*member, Rule rule) {
  return field<Owner>(
      std::move(key), [member](Owner& owner) -> T& { return owner.*member; }, rule);
}

struct RowTable : KeyTable {
  RowTable(std::string_view map_name, std::string_view what_for_faults)
      : KeyTable{map_name, what_for_faults, {}} {}
  RowTable(const RowTable&) = delete;
  RowTable& operator=(const RowTable&) = delete;

  std::vector<Key> rows;
  std::string text;                        // purpose of the map
  std::vector<std::string_view> one_of{};  // exactly one of these keys is required

 protected:
  void list_names() {
    for (const Key& row : rows) names_.push_back(row.name);
    keys = names_;
  }

 private:
  std::vector<std::string_view> names_;
};

template <typename Owner>
class Rows : public RowTable {
 public:
  Rows(std::string_view map_name, std::string_view what_for_faults,
       std::vector<Field<Owner>> fields, const std::string& about = {},
       const std::vector<std::string_view>& exclusive = {})
      : RowTable(map_name, what_for_faults), fields_(std::move(fields)) {
    for (const auto& each : fields_) rows.push_back(each.key);
    text = about;
    one_of = exclusive;
    list_names();
  }

  void read(MapReader& map, Owner& owner) const {
    for (const auto& each : fields_) {
      if (each.read) each.read(map, owner);
    }
  }
  // Reads the map of this key, if there is one.
  void read_section(MapReader& around, std::string_view key, Owner& owner) const {
    const Node* node = around.find(key);
    if (node == nullptr) return;
    MapReader map(*node, *this, around.faults());
    read(map, owner);
  }
  [[nodiscard]] const std::vector<Field<Owner>>& fields() const { return fields_; }

 private:
  std::vector<Field<Owner>> fields_;
};

// Appends the inheritable rows of `inner`; the owner stores their values at `access`.
template <typename Owner, typename Inner, typename Access>
void append_flowing(std::vector<Field<Owner>>& fields, const std::vector<Field<Inner>>& inner,
                    Access access) {
  for (const Field<Inner>& each : inner) {
    if (!each.key.flows_down) continue;
    Key key = each.key;
    key.from_below = true;
    fields.push_back({std::move(key), [read = each.read, access](MapReader& map, Owner& owner) {
                        read(map, std::invoke(access, owner));
                      }});
  }
}

}  // namespace fieldcast::config
