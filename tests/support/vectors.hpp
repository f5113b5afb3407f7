// Golden frames from published sources: tests/vectors/<family>.json.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

struct GoldenVector {
  std::string name;
  std::string kind;     // "ok", "exception", "malformed"
  std::string framing;  // of Modbus and FINS
  std::string expect;   // expected fault of a malformed frame
  Bytes request;        // empty: that side is not part of the vector
  Bytes response;
  std::vector<Bytes> master;                 // dialogue: what the master sends,
  std::vector<Bytes> slave;                  // and the data that follows each (joined if several)
  std::map<std::string, std::string> texts;  // every field; others than texts as JSON

  [[nodiscard]] bool has(const std::string& field) const { return texts.contains(field); }
  [[nodiscard]] Bytes hex(const std::string& field) const;  // empty if the field is missing
};

void PrintTo(const GoldenVector& vector, std::ostream* out);

// Loads the vectors of a family in the tree, and those of a larger collection if configured
// (FIELDCAST_VECTORS in the environment or at configuration time). A duplicate name is skipped. A
// broken file adds a gtest failure.
[[nodiscard]] std::vector<GoldenVector> load_vectors(const std::string& family);

}  // namespace fieldcast::test
