#include "config/document/map_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "config/document/suggest.hpp"

namespace fieldcast::config {

namespace {

[[noreturn]] void bug(std::string_view what, std::string_view key) {
  std::fprintf(stderr, "config: %.*s: %.*s\n", static_cast<int>(what.size()), what.data(),
               static_cast<int>(key.size()), key.data());
  std::abort();
}

bool begins_comment(const Node& key) {
  const auto text = key.position.source->line(key.position.line);
  const auto behind = text.find(':', std::min<std::size_t>(text.size(), key.position.column));
  const auto sign = behind == text.npos ? behind : text.find_first_not_of(" \t", behind + 1);
  return sign != text.npos && text[sign] == '#';
}

}  // namespace

MapReader::MapReader(const Node& node, const KeyTable& table, FaultList& faults)
    : node_(node), table_(table), faults_(faults), read_(table.keys.size()) {
  if (node.kind != Kind::kMap) {
    faults_.add(node.position, fmt::format("{} is {}", table.what, to_text(node.kind)),
                "a map with " + joined(table.keys));
    return;
  }
  for (const auto& [key, value] : node.entries) {
    if (std::ranges::find(table.keys, key->text) != table.keys.end()) continue;
    if (key->text == "<<") {
      faults_.add(key->position, "a merge key '<<'",
                  "defaults, templates, and aliases of whole values");
      continue;
    }
    auto meant = meant_key(key->text, table.keys);
    faults_.add(key->position,
                fmt::format("unknown key '{}' in {}{}", key->text, table.what,
                            meant.key.empty() ? where_it_belongs(key->text, table) : std::string{}),
                joined(table.keys), meant.text);
    if (!meant.key.empty()) meant_.push_back(std::move(meant.key));
  }
}

MapReader::~MapReader() {
  for (std::size_t i = 0; i < read_.size(); ++i) {
    if (!read_[i]) bug("a key is listed and never read", table_.keys[i]);
  }
}

const Node::Entry* MapReader::entry(std::string_view key) const {
  for (const auto& entry : node_.entries) {
    if (entry.key->text == key) return &entry;
  }
  return nullptr;
}

const Node* MapReader::find(std::string_view key) {
  const auto listed = std::ranges::find(table_.keys, key);
  if (listed == table_.keys.end()) bug("a key is read and not listed", key);
  read_[static_cast<std::size_t>(listed - table_.keys.begin())] = true;
  const auto* found = entry(key);
  if (found == nullptr) return nullptr;
  if (found->value->kind == Kind::kNull) {
    faults_.add(found->key->position, fmt::format("'{}' has no value", key),
                begins_comment(*found->key)
                    ? "a value; '#' begins a comment, so a text that begins with it needs quotes"
                    : "");
    return nullptr;
  }
  return found->value;
}

const Node* MapReader::require(std::string_view key, std::string_view allowed) {
  const Node* value = find(key);
  if (value == nullptr && is_map() && !has_or_means(key)) {
    faults_.add(node_.position, fmt::format("'{}' is missing in {}", key, table_.what), allowed);
  }
  return value;
}

bool MapReader::has(std::string_view key) const { return entry(key) != nullptr; }

bool MapReader::has_or_means(std::string_view key) const {
  return has(key) || std::ranges::find(meant_, key) != meant_.end();
}

Position MapReader::position_of(std::string_view key) const {
  const auto* found = entry(key);
  return found == nullptr ? node_.position : found->value->position;
}

}  // namespace fieldcast::config
