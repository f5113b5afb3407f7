// One key of the format: name, rule for its value, default and description. The parser, fault
// messages, the JSON Schema and the tables of config/README.md all use these rows, so they cannot
// differ. Constant once made; any thread.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/document/keys.hpp"
#include "config/document/map_reader.hpp"

namespace fieldcast::config {

inline constexpr std::string_view kNeeded = "needed";  // default of a required key

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
