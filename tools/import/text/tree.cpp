#include "tools/import/text/tree.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/value.hpp"

namespace fieldcast::importing {

Tree read_yaml_tree(std::string_view text) {
  config::FaultList faults;
  auto document = config::parse_yaml(config::Source{.file = "", .text = std::string(text)}, faults);
  if (!faults.empty()) {
    const config::Fault fault = faults.take().front();
    return refused("line {}: {}", fault.line, fault.what);
  }
  if (document->root == nullptr) return refused("it is empty");
  return document;
}

const Node* child(const Node& map, std::string_view key) {
  if (map.kind != config::Kind::kMap) return nullptr;
  const auto found = std::ranges::find_if(
      map.entries, [&](const Node::Entry& entry) { return entry.key->text == key; });
  return found == map.entries.end() ? nullptr : found->value;
}

std::string_view text_of(const Node* node) {
  if (node == nullptr || node->kind != config::Kind::kScalar) return {};
  return node->text;
}

std::string_view text_at(const Node& map, std::string_view key) { return text_of(child(map, key)); }

std::string_view first_text(const Node& map, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (const std::string_view text = text_at(map, key); !text.empty()) return text;
  }
  return {};
}

std::optional<double> number_at(const Node& map, std::string_view key) {
  return number_from(text_at(map, key));
}

MayFail fault_of_number(const Node& map, std::string_view key) {
  const std::string_view text = text_at(map, key);
  if (text.empty() || number_from(text)) return std::nullopt;
  return fmt::format("{} '{}' is no number", key, text);
}

MayFail read_scale_at(const Node& map, std::string_view key, double& scale) {
  if (auto fault = fault_of_number(map, key)) return fault;
  if (const auto number = number_at(map, key); number && *number != 0) scale = *number;
  return std::nullopt;
}

std::optional<std::uint64_t> whole_at(const Node& map, std::string_view key) {
  return whole_from(text_at(map, key));
}

std::optional<bool> bool_at(const Node& map, std::string_view key) {
  const std::string word = lower(text_at(map, key));
  if (word.empty()) return std::nullopt;
  return is_one_of(word, "true yes on 1");
}

bool is_list(const Node* node) { return node != nullptr && node->kind == config::Kind::kList; }
bool is_map(const Node* node) { return node != nullptr && node->kind == config::Kind::kMap; }

const config::LeanList<const Node*>& items_of(const Node* node) {
  static const config::LeanList<const Node*> kNone;
  return is_list(node) ? node->items : kNone;
}

namespace {

// Counts lines, because SAX events have none. Copies share the count.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, std::uint32_t* lines) : at_(at), lines_(lines) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n') ++*lines_;
    ++at_;
    return *this;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) {
    return a.at_ == b.at_;
  }

 private:
  const char* at_;
  std::uint32_t* lines_;
};

class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(config::Document& document, const std::uint32_t& line)
      : document_(document), line_(line) {}

  bool null() override { return add(config::Kind::kNull, {}); }
  bool boolean(bool value) override { return scalar(value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override { return scalar(std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) override { return scalar(std::to_string(value)); }
  bool number_float(number_float_t value, const string_t&) override {
    return scalar(number_text(value));
  }
  bool string(string_t& value) override { return scalar(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(config::Kind::kMap); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(config::Kind::kList); }
  bool end_array() override { return close(); }
  bool key(string_t& value) override {
    open_.back().key = make(config::Kind::kScalar, std::move(value));
    return open_.back().key != nullptr;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    fault_ = fmt::format("line {}: no JSON from here on", line_ + 1);
    return false;
  }
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  Node* make(config::Kind kind, std::string text) {
    if (document_.nodes.size() == kMaxTreeNodes) {
      fault_ = fmt::format("line {}: more than {} values", line_ + 1, kMaxTreeNodes);
      return nullptr;
    }
    Node& node = document_.nodes.emplace_back();
    node.kind = kind;
    node.text = std::move(text);
    node.position = {&document_.source, line_, 0};
    return &node;
  }

  bool add(config::Kind kind, std::string text) {
    Node* node = make(kind, std::move(text));
    if (node == nullptr) return false;
    if (open_.empty()) {
      document_.root = node;
    } else if (open_.back().node->kind == config::Kind::kList) {
      open_.back().node->items.push_back(node);
    } else {
      open_.back().node->entries.push_back({open_.back().key, node});
    }
    return true;
  }
  bool scalar(std::string text) { return add(config::Kind::kScalar, std::move(text)); }

  bool open(config::Kind kind) {
    if (open_.size() == kMaxTreeDepth) {
      fault_ = fmt::format("line {}: nested deeper than {} levels", line_ + 1, kMaxTreeDepth);
      return false;
    }
    if (!add(kind, {})) return false;
    open_.push_back({&document_.nodes.back(), nullptr});
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  struct Level {
    Node* node;
    Node* key;  // of the next value of a map
  };
  config::Document& document_;
  const std::uint32_t& line_;
  std::vector<Level> open_;
  std::string fault_;
};

}  // namespace

Tree read_json(std::string_view text) {
  auto document = std::make_unique<config::Document>();
  std::uint32_t line = 0;
  TreeBuilder builder(*document, line);
  const bool done = nlohmann::json::sax_parse(
      CountingIterator(text.data(), &line), CountingIterator(text.data() + text.size(), &line),
      &builder, nlohmann::json::input_format_t::json, true, true);
  if (!done || document->root == nullptr)
    return tl::unexpected(builder.fault().empty() ? "no JSON" : builder.fault());
  return document;
}

}  // namespace fieldcast::importing
