#include "config/document/fault.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/document.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {

namespace {

// Null if the node has no such key or item.
const Node* below(const Node& node, std::string_view step) {
  if (node.kind == Kind::kList) {
    const auto index = whole_from(step);
    const bool found = index && *index >= 0 && static_cast<std::size_t>(*index) < node.items.size();
    return found ? node.items[static_cast<std::size_t>(*index)] : nullptr;
  }
  const auto* const entry = std::ranges::find(
      node.entries, step, [](const Node::Entry& one) { return std::string_view(one.key->text); });
  return entry == node.entries.end() ? nullptr : entry->value;
}

unsigned last_line(const Node& node) {
  unsigned last = node.position.line + 1;
  for (const Node* item : node.items) last = std::max(last, last_line(*item));
  for (const Node::Entry& entry : node.entries) last = std::max(last, last_line(*entry.value));
  return last;
}

}  // namespace

std::optional<Places::Lines> Places::lines(std::string_view path) const {
  if (document_ == nullptr || document_->root == nullptr) return std::nullopt;
  const Node* node = document_->root;
  unsigned first = 1;
  while (!path.empty()) {
    const auto end = std::min(path.find('.'), path.size());
    const std::string_view step = path.substr(0, end);
    const auto* const entry = std::ranges::find(node->entries, step, [](const Node::Entry& one) {
      return std::string_view(one.key->text);
    });
    const Node* const next = below(*node, step);
    if (next == nullptr) return std::nullopt;
    first = entry == node->entries.end() ? next->position.line + 1 : entry->key->position.line + 1;
    node = next;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return Lines{first, last_line(*node)};
}

std::string Places::at(std::string_view path) const {
  if (document_ == nullptr || document_->root == nullptr) return {};
  const Node* node = document_->root;
  while (!path.empty()) {
    const auto end = std::min(path.find('.'), path.size());
    const Node* const next = below(*node, path.substr(0, end));
    if (next == nullptr) break;
    node = next;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  const Position& position = node->position;
  return fmt::format("{}:{}:{}", position.source->file, position.line + 1, column_of(position));
}

}  // namespace fieldcast::config
