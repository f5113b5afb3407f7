// One key of the format as one row: its name, the rule for its value, its default, what it means.
// Parsing, the lists in faults, the JSON Schema and the tables of config/README.md come from the
// rows, so that none of them can know a key that another one does not.
//
// Constant once made; any thread.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/keys.hpp"
#include "config/map_reader.hpp"

namespace fieldcast::config {

inline constexpr std::string_view kNeeded = "needed";  // a default: there is none

struct Key {
  std::string_view name;
  std::string fallback{};   // the default, for people; kNeeded: absence is a fault
  std::string text{};       // what the key is for; stands in the schema and in the README
  bool flows_down = false;  // it may also stand further up, as a default
  std::string example{};    // for the fault that the key is missing; empty: the text
  std::string column{};     // of a channel list; empty: the key's name
  std::string schema{};     // of its value, as JSON; empty: its rule says it
  std::string form{};       // of its value, for people; empty: its rule says it
  bool from_below = false;  // explained in the table that it flows down to
};

// A row with what reads it into an Owner; nothing: code reads it by name.
template <typename Owner>
struct Field {
  Key key;
  std::function<void(MapReader& map, Owner& owner)> read{};
};

// `access(owner)` is what the value is put into: a pointer to a member, or a function.
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

// The keys of one map of the format, without their readers.
struct RowTable : KeyTable {
  RowTable(std::string_view map_name, std::string_view what_for_faults)
      : KeyTable{map_name, what_for_faults, {}} {}
  RowTable(const RowTable&) = delete;
  RowTable& operator=(const RowTable&) = delete;

  std::vector<Key> rows;
  std::string text;                        // what the map is for
  std::vector<std::string_view> one_of{};  // exactly one of these keys must be there

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

  // Reads every key that has a reader.
  void read(MapReader& map, Owner& owner) const {
    for (const auto& each : fields_) {
      if (each.read) each.read(map, owner);
    }
  }
  [[nodiscard]] const std::vector<Field<Owner>>& fields() const { return fields_; }

 private:
  std::vector<Field<Owner>> fields_;
};

// Those of `inner` that flow down, for a map further up, whose owner holds theirs at `access`.
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
