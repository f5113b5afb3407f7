// A text as a tree of nodes with positions, which point into their Document. Not copied or moved.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "config/document/fault.hpp"

namespace fieldcast::config {

class FaultList;

struct Source {
  std::string file;  // as shown in faults
  std::string text;
  std::size_t order = 0;  // 0: the main file; others in the order of opening

  // Without its end; empty after the last one. The text must not change after the first call.
  [[nodiscard]] std::string_view line(std::uint32_t number) const;
  mutable std::vector<std::size_t> line_starts{};  // filled by the first call of line()
};

struct Position {
  const Source* source = nullptr;
  std::uint32_t line = 0;    // from 0
  std::uint32_t column = 0;  // from 0, in bytes
};

// The column as editors count: from 1, in characters.
[[nodiscard]] unsigned column_of(const Position& position);

enum class Kind : std::uint8_t { kNull, kScalar, kList, kMap };

// Empty in most nodes: one pointer instead of three.
template <typename T>
class LeanList {
 public:
  void push_back(const T& value) {
    if (!all_) all_ = std::make_unique<std::vector<T>>();
    all_->push_back(value);
  }
  [[nodiscard]] std::size_t size() const { return all_ ? all_->size() : 0; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] const T* begin() const { return all_ ? all_->data() : nullptr; }
  [[nodiscard]] const T* end() const { return begin() + size(); }
  const T& operator[](std::size_t at) const { return (*all_)[at]; }

 private:
  std::unique_ptr<std::vector<T>> all_;
};

struct Node {
  struct Entry {
    const Node* key;  // always a scalar, unique in its map
    const Node* value;
  };
  Kind kind = Kind::kNull;
  bool quoted = false;  // a quoted scalar is text, never a number
  Position position;
  std::string text;  // of a scalar
  LeanList<const Node*> items;
  LeanList<Entry> entries;
};

struct Document {
  Source source;
  std::deque<Node> nodes;
  const Node* root = nullptr;  // null if the text is invalid (with a fault) or empty

  Document() = default;
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
};

// Adds all faults, for example duplicate keys, tags, too many or too deep nodes.
[[nodiscard]] std::unique_ptr<Document> parse_yaml(Source source, FaultList& faults);

// A list of maps, one per row, with the keys of a channel (see columns() in keys.hpp).
[[nodiscard]] std::unique_ptr<Document> parse_csv(Source source, FaultList& faults);

// Removes a byte order mark. Returns false with a fault for invalid UTF-8 or control characters.
[[nodiscard]] bool check_text(Source& source, FaultList& faults);

// "a list", for faults.
[[nodiscard]] std::string_view to_text(Kind kind);

// With a trailing '/'; empty for a bare name.
[[nodiscard]] std::string_view directory_of(std::string_view path);
// Relative to the directory of the referring file.
[[nodiscard]] std::string resolve(const Source& from, std::string_view path);

// Collects the faults of one load, without duplicates, at most kMaxFaults.
class FaultList {
 public:
  // Ignores a duplicate: a template is read once for each device that uses it.
  void add(const Position& position, std::string_view what, std::string_view allowed = {},
           std::string_view suggestion = {});

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool full() const;

  // Sorted by file (the main one first), line and column; clears the list.
  [[nodiscard]] std::vector<Fault> take();

 private:
  struct Entry {
    std::size_t order;
    Fault fault;
  };
  std::vector<Entry> entries_;
  std::set<std::tuple<std::size_t, std::uint32_t, std::uint32_t, std::string>> known_;
};

// Adds a fault for the second use of a name.
class UniqueNames {
 public:
  // Ignores an empty name, which already has a fault.
  void add(std::string_view what, const std::string& name, const Position& position,
           FaultList& faults) {
    if (name.empty()) return;
    const auto [first, fresh] = positions_.emplace(name, position);
    if (fresh) return;
    const Position& there = first->second;
    const std::string file = there.source == position.source ? "" : there.source->file + ", ";
    faults.add(position, std::string(what) + " '" + name + "' exists already (" + file + "line " +
                             std::to_string(there.line + 1) + ')');
  }

 private:
  std::map<std::string, Position> positions_;
};

}  // namespace fieldcast::config
