// The schema for editors and the loader say the same: the same keys, and every file that loads fits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "config/fault_list.hpp"
#include "config/keys.hpp"
#include "core/protocol/protocol.hpp"
#include "tests/config/json_schema.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

using nlohmann::json;

const json& schema() {
  static const json text = json::parse(slurp(source_dir() / "config/fieldcast.schema.json"));
  return text;
}

// The reason why a YAML file does not fit; "no YAML" when it cannot be parsed.
std::string misfit_of(const std::filesystem::path& path, const std::string& definition) {
  FaultList faults;
  const auto document = parse_yaml(Source{path.filename().string(), slurp(path), 0}, faults);
  if (document->root == nullptr || !faults.empty()) return "no YAML";
  return misfit(json_of(*document->root), schema()["$defs"][definition], schema());
}

TEST(Schema, KnowsExactlyTheKeysThatTheLoaderKnows) {
  for (const KeyTable* table : key_tables()) {
    ASSERT_TRUE(schema()["$defs"].contains(table->name)) << table->name;
    const auto& definition = schema()["$defs"][std::string(table->name)];
    EXPECT_EQ(definition["additionalProperties"], false) << table->name;
    std::set<std::string> theirs;
    for (const auto& [key, rule] : definition["properties"].items()) theirs.insert(key);
    const std::set<std::string> ours(table->keys.begin(), table->keys.end());
    EXPECT_EQ(theirs, ours) << table->name;
  }
}

TEST(Schema, HasNoMapsThatTheLoaderDoesNotKnow) {
  std::set<std::string> known;
  for (const KeyTable* table : key_tables()) known.insert(std::string(table->name));
  for (const auto& [name, definition] : schema()["$defs"].items()) {
    EXPECT_TRUE(!definition.contains("properties") || known.contains(name)) << name;
  }
}

TEST(Schema, NamesEveryProtocol) {
  std::set<std::string> ours;
  for (const auto& entry : protocols()) ours.insert(std::string(entry.name));
  EXPECT_EQ(schema()["$defs"]["protocol"]["anyOf"][0]["enum"].get<std::set<std::string>>(), ours)
      << "a new protocol also stands in config/fieldcast.schema.json";
}

TEST(Schema, OfTemplatesIsThatOfTheirDefinition) {
  const auto text = json::parse(slurp(source_dir() / "config/template.schema.json"));
  EXPECT_EQ(text["$ref"], "fieldcast.schema.json#/$defs/template");
}

TEST(Schema, EveryFileThatLoadsFits) {
  for (const auto* folder : {"config/examples", "tests/config/good"}) {
    for (const auto& path : files_of(source_dir() / folder, ".yaml")) EXPECT_EQ(misfit_of(path, "bridge"), "") << path;
  }
  for (const auto& path : files_of(source_dir() / "config/devices", ".yaml")) EXPECT_EQ(misfit_of(path, "template"), "") << path;
}

// What one value alone makes wrong, an editor can underline; rules between keys are the loader's alone.
TEST(Schema, RefusesEveryBadFileWhoseFaultLiesInOneValue) {
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
  for (const auto& path : files_of(source_dir() / "tests/config/bad", ".yaml")) {
    const auto text = slurp(path);
    const std::string own = "# expect: " + path.filename().string();
    bool visible = false;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line) && line.starts_with("# expect: ");) {
      for (const auto mark : kSeen) visible |= line.starts_with(own) && line.find(mark) != std::string::npos;
    }
    if (!visible) continue;
    ++seen;
    EXPECT_NE(misfit_of(path, "bridge"), "") << path;
  }
  EXPECT_GT(seen, 40u);
}

}  // namespace
}  // namespace fieldcast::config
