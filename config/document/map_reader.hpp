// Reads the keys of one map. The constructor adds faults for unknown keys; known keys are read by
// name. Borrows the node and the fault list. Aborts at the end if a key of the table was never
// read, which is a bug.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "config/document/document.hpp"
#include "config/document/fault_list.hpp"
#include "config/document/keys.hpp"

namespace fieldcast::config {

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

}  // namespace fieldcast::config
