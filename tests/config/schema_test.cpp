// Tests that the schema for editors has the loader's keys and fits every file that loads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "config/declaration/declared_frame.hpp"
#include "config/document/document.hpp"
#include "config/document/map_reader.hpp"
#include "config/keys/documents.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/config/json_schema.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

using nlohmann::json;

const json& schema() {
  static const json text = json::parse(slurp(source_dir() / "config/fieldcast.schema.json"));
  return text;
}
const json& protocol_schema() {
  static const json text = json::parse(slurp(source_dir() / "config/protocol.schema.json"));
  return text;
}

std::string misfit_of_text(const std::string& text, const std::string& definition,
                           const json& whole = schema()) {
  FaultList faults;
  const auto document = parse_yaml(Source{"bad.yaml", text, 0}, faults);
  if (document->root == nullptr || !faults.empty()) return "no YAML";
  return misfit(json_of(*document->root), whole["$defs"][definition], whole);
}

std::string misfit_of(const std::filesystem::path& path, const std::string& definition,
                      const json& whole = schema()) {
  return misfit_of_text(slurp(path), definition, whole);
}

template <typename Tables>
void expect_same_keys(const Tables& tables, const json& whole) {
  std::set<std::string> known;
  for (const KeyTable* table : tables) {
    known.insert(std::string(table->name));
    ASSERT_TRUE(whole["$defs"].contains(table->name)) << table->name;
    const auto& definition = whole["$defs"][std::string(table->name)];
    EXPECT_EQ(definition["additionalProperties"], false) << table->name;
    std::set<std::string> theirs;
    for (const auto& [key, rule] : definition["properties"].items()) theirs.insert(key);
    const std::set<std::string> ours(table->keys.begin(), table->keys.end());
    EXPECT_EQ(theirs, ours) << table->name;
  }
  for (const auto& [name, definition] : whole["$defs"].items()) {
    EXPECT_TRUE(!definition.contains("properties") || known.contains(name))
        << "the loader knows no map " << name;
  }
}

TEST(Schema, IsThatOfTheKeys) {
  EXPECT_EQ(slurp(source_dir() / "config/fieldcast.schema.json"), schema_text())
      << "cmake --build build --target documents generates it again";
}

TEST(Schema, KnowsExactlyTheKeysThatTheLoaderKnows) { expect_same_keys(key_tables(), schema()); }

TEST(ProtocolSchema, KnowsExactlyTheKeysThatTheLoaderKnows) {
  expect_same_keys(declaration_key_tables(), protocol_schema());
}

TEST(Schema, NamesEveryProtocol) {
  std::set<std::string> ours;
  for (const auto& entry : protocols()) ours.insert(std::string(entry.name));
  EXPECT_EQ(schema()["$defs"]["protocol"]["anyOf"][0]["enum"].get<std::set<std::string>>(), ours)
      << "cmake --build build --target documents generates it again";
}

TEST(Schema, OfTemplatesIsThatOfTheirDefinition) {
  const auto text = json::parse(slurp(source_dir() / "config/template.schema.json"));
  EXPECT_EQ(text["$ref"], "fieldcast.schema.json#/$defs/template");
}

TEST(Schema, EveryFileThatLoadsFits) {
  for (const auto* folder : {"config/examples", "tests/config/good"}) {
    for (const auto& path : files_of(source_dir() / folder, ".yaml"))
      EXPECT_EQ(misfit_of(path, "bridge"), "") << path;
  }
  for (const auto& path : files_of(source_dir() / "config/devices", ".yaml"))
    EXPECT_EQ(misfit_of(path, "template"), "") << path;
}

// The schema covers faults of single values; only the loader checks rules between keys.
TEST(Schema, RefusesEveryBadFileWithItsFaultInOneValue) {
  static constexpr std::string_view kSeen[] = {"unknown key",
                                               "'name' is missing",
                                               "'address' is missing",
                                               "'port' is missing",
                                               "'devices' is missing",
                                               "'buses' is missing",
                                               "'bridge' is missing",
                                               "'at' is missing",
                                               " has no unit",
                                               " is no duration",
                                               " is out of range",
                                               " is negative",
                                               " has no value",
                                               " is empty",
                                               " is no number",
                                               " is quoted",
                                               " is no whole",
                                               " neither true nor",
                                               "both serial and tcp",
                                               " is a map",
                                               " is a single v",
                                               " is no rate",
                                               "type 'string'",
                                               "level '",
                                               "access '"};
  unsigned seen = 0;
  for (const auto& bad : bad_cases(source_dir() / "tests/config/bad")) {
    const std::string own = bad.file();
    bool visible = false;
    std::istringstream lines(bad.expected());
    for (std::string line; std::getline(lines, line);) {
      // The protocol decides whether an address is a number or a text.
      if (line.find(": address '") != std::string::npos) continue;
      for (const auto mark : kSeen)
        visible |= line.starts_with(own) && line.find(mark) != std::string::npos;
    }
    if (!visible) continue;
    ++seen;
    EXPECT_NE(misfit_of_text(bad.text, "bridge"), "") << bad.name;
  }
  EXPECT_GT(seen, 40u);
}

TEST(ProtocolSchema, EveryDeclarationThatLoadsFits) {
  unsigned seen = 0;
  for (const auto& path : files_of(source_dir() / "config/protocols", ".yaml")) {
    ++seen;
    EXPECT_EQ(misfit_of(path, "declaration", protocol_schema()), "") << path;
  }
  EXPECT_GE(seen, 2u);
}

// The words of every closed set, from the loader's message for an unknown word.
TEST(ProtocolSchema, KnowsExactlyTheWordsThatTheLoaderKnows) {
  const std::pair<std::string, std::string> choices[] = {
      {"declaration/encoding", "encoding: xx"},
      {"declaration/order", "order: xx"},
      {"declaration/bit-order", "bit-order: xx"},
      {"declaration/escape", "escape: xx"},
      {"area/item", "areas: [{ name: a, item: xx }]"},
      {"area/base", "areas: [{ name: a, base: xx }]"},
      {"field/is", "{ is: xx }"},
      {"field/as", "{ is: count, as: xx }"},
      {"field/order", "{ is: count, order: xx }"},
      {"field/kind", "{ is: checksum, of: a, kind: xx }"},
      {"field/complement", "{ is: checksum, of: a, kind: sum, complement: xx }"},
      {"field/over", "{ is: checksum, of: a, kind: sum, over: xx }"},
      {"field/counts", "{ is: length, of: a, counts: xx }"}};
  for (const auto& [place, text] : choices) {
    const auto slash = place.find('/');
    const auto& property =
        protocol_schema()["$defs"][place.substr(0, slash)]["properties"][place.substr(slash + 1)];
    // A kind may also be a CRC by name or by its parameters.
    const auto& rule = property.contains("anyOf") ? property["anyOf"][0] : property;
    std::string words;
    for (const auto& word : rule["enum"])
      words += (words.empty() ? "" : ", ") + word.get<std::string>();
    const bool field = place.starts_with("field");
    const auto loaded = load_declaration_text(
        field ? "areas: [{ name: a }]\noperations: [{ name: r, read: a, request: [" + text +
                    "], answer: [" + text + "] }]\n"
              : "summary: s\n" + text,
        "t.yaml");
    ASSERT_FALSE(loaded);
    EXPECT_TRUE(std::ranges::any_of(loaded.error(),
                                    [&](const Fault& fault) {
                                      return fault.what.find("'xx' is unknown") !=
                                                 std::string::npos &&
                                             fault.allowed.starts_with(words);
                                    }))
        << place << ": " << words << '\n'
        << to_text(std::span(loaded.error()));
  }
}

// The schema covers single values and missing keys; only the loader checks rules between fields.
TEST(ProtocolSchema, RefusesEveryBadDeclarationWithItsFaultInOneValue) {
  static constexpr std::string_view kSeen[] = {"unknown key",
                                               "'summary' is missing",
                                               "'addresses' is missing",
                                               "'areas' is missing",
                                               "'request' is missing",
                                               "' is unknown;",
                                               "is no whole",
                                               " is empty",
                                               " is a map",
                                               " is a list",
                                               "busy is",
                                               "a constant and something else",
                                               "neither constant",
                                               "reads and writes",
                                               "neither reads nor writes"};
  unsigned seen = 0;
  for (const auto& bad : bad_cases(source_dir() / "tests/config/bad_protocols")) {
    std::istringstream lines(bad.expected());
    bool visible = false;
    for (std::string line; std::getline(lines, line);) {
      // The protocol decides whether an address is a number or a text.
      if (line.find(": address '") != std::string::npos) continue;
      for (const auto mark : kSeen)
        visible |= line.find(mark) != std::string::npos && !line.starts_with("code-is");
    }
    if (!visible) continue;
    ++seen;
    EXPECT_NE(misfit_of_text(bad.text, "declaration", protocol_schema()), "") << bad.name;
  }
  EXPECT_GE(seen, 14u);
}

}  // namespace
}  // namespace fieldcast::config
