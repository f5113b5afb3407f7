// TOML as a tree, by toml++. On some broken texts it fails an assertion of its own (3.3.0: "[.a]"):
// here that is an exception, and the text is refused.
#include <fmt/format.h>

#include <stdexcept>

namespace fieldcast::importing {
constexpr void require_toml(bool holds) {
  if (!holds) throw std::logic_error("a key or a value that is none");
}
}  // namespace fieldcast::importing

#define TOML_EXCEPTIONS 1
#undef TOML_ASSERT
#define TOML_ASSERT(...) ::fieldcast::importing::require_toml(static_cast<bool>(__VA_ARGS__))
#include <toml++/toml.h>

#include "core/base/number_text.hpp"
#include "tools/import/tree.hpp"

namespace fieldcast::importing {
namespace {

class TomlTree {
 public:
  explicit TomlTree(config::Document& document) : document_(document) {}

  // Nothing beyond the bounds.
  const Node* add(const toml::node& from, std::size_t depth) {
    if (depth == kMaxTreeDepth || document_.nodes.size() >= kMaxTreeNodes) return nullptr;
    Node& node = make(from.source());
    if (const auto* table = from.as_table()) {
      node.kind = config::Kind::kMap;
      for (const auto& [key, value] : *table) {
        const Node* held = add(value, depth + 1);
        if (held == nullptr) return nullptr;
        Node& name = make(key.source());
        name.kind = config::Kind::kScalar;
        name.text = std::string(key.str());
        node.entries.push_back({&name, held});
      }
    } else if (const auto* list = from.as_array()) {
      node.kind = config::Kind::kList;
      for (const auto& item : *list) {
        const Node* held = add(item, depth + 1);
        if (held == nullptr) return nullptr;
        node.items.push_back(held);
      }
    } else {
      node.kind = config::Kind::kScalar;
      node.text = text_of_value(from);
      node.quoted = from.is_string();
    }
    return &node;
  }

 private:
  static std::string text_of_value(const toml::node& from) {
    if (const auto* text = from.as_string()) return text->get();
    if (const auto* whole = from.as_integer()) return std::to_string(whole->get());
    if (const auto* number = from.as_floating_point()) return number_text(number->get());
    if (const auto* truth = from.as_boolean()) return truth->get() ? "true" : "false";
    return {};  // a date
  }

  Node& make(const toml::source_region& region) {
    Node& node = document_.nodes.emplace_back();
    const auto line = static_cast<std::uint32_t>(region.begin.line);
    node.position = {&document_.source, line == 0 ? 0 : line - 1, 0};
    return node;
  }

  config::Document& document_;
};

}  // namespace

Tree read_toml(std::string_view text) {
  toml::table parsed;
  try {
    parsed = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return tl::unexpected(fmt::format("line {}: no TOML: {}",
                                      static_cast<unsigned>(error.source().begin.line),
                                      std::string(error.description())));
  } catch (const std::exception& error) {
    return tl::unexpected(fmt::format("no TOML: {}", error.what()));
  }
  auto document = std::make_unique<config::Document>();
  document->root = TomlTree(*document).add(parsed, 0);
  if (document->root == nullptr) return tl::unexpected(std::string("too many or too deep values"));
  return document;
}

}  // namespace fieldcast::importing
