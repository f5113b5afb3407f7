#include "tests/support/vectors.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

namespace fieldcast::test {
namespace {

using nlohmann::json;

GoldenVector vector_of(const json& object) {
  GoldenVector vector;
  for (const auto& [field, value] : object.items()) {
    if (value.is_null()) continue;
    vector.texts[field] = value.is_string() ? value.get<std::string>() : value.dump();
  }
  vector.name = vector.texts["name"];
  vector.kind = vector.texts["kind"];
  vector.framing = vector.texts["framing"];
  vector.expect = vector.texts["expect"];
  vector.request = vector.hex("request_hex");
  vector.response = vector.hex("response_hex");
  if (object.contains("exchange")) {
    for (const json& step : object["exchange"]) {
      const Bytes bytes = from_hex(step.value("hex", "")).value_or(Bytes{});
      const std::string direction = step.value("dir", "");  // "M>S" of a master, "H>P" of a host
      if (direction == "M>S" || direction == "H>P") {
        vector.master.push_back(bytes);
        vector.slave.emplace_back();
      } else if (!vector.slave.empty()) {
        append(vector.slave.back(), bytes);
      }
    }
  }
  return vector;
}

void load_file(const std::filesystem::path& path, std::vector<GoldenVector>& vectors,
               std::set<std::string>& names) {
  std::ifstream file(path);
  const json all = json::parse(file, nullptr, false);
  if (!all.is_array()) {
    ADD_FAILURE() << path << " is no list of vectors";
    return;
  }
  for (const json& object : all) {
    GoldenVector vector = vector_of(object);
    if (names.insert(vector.name).second) vectors.push_back(std::move(vector));
  }
}

}  // namespace

Bytes GoldenVector::hex(const std::string& field) const {
  const auto found = texts.find(field);
  if (found == texts.end()) return {};
  const auto bytes = from_hex(found->second);
  if (!bytes) ADD_FAILURE() << name << "." << field << " is no hexadecimal text";
  return bytes.value_or(Bytes{});
}

void PrintTo(const GoldenVector& vector, std::ostream* out) { *out << vector.name; }

std::vector<GoldenVector> load_vectors(const std::string& family) {
  std::vector<GoldenVector> vectors;
  std::set<std::string> names;
  load_file(std::filesystem::path(FIELDCAST_TREE_VECTORS) / (family + ".json"), vectors, names);
  const char* const chosen = std::getenv("FIELDCAST_VECTORS");
  const std::filesystem::path wider =
      std::filesystem::path(chosen != nullptr ? chosen : FIELDCAST_WIDER_VECTORS) /
      (family + ".json");
  if (std::filesystem::exists(wider)) load_file(wider, vectors, names);
  return vectors;
}

}  // namespace fieldcast::test
