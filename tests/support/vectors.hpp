// Golden frames from published sources: tests/vectors/<family>.json, one object for each frame or
// dialogue.
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
  std::string expect;   // what a decoder should say of a malformed one
  Bytes request;        // empty: that side is not part of the vector
  Bytes response;
  std::vector<Bytes> master;  // of a dialogue: what the master sends,
  std::vector<Bytes>
      slave;  // and what comes back after each of those (joined where several follow)
  std::map<std::string, std::string> texts;  // every field that is a text, as it stands

  [[nodiscard]] bool has(const std::string& field) const { return texts.contains(field); }
  [[nodiscard]] Bytes hex(const std::string& field) const;  // empty when the field is missing
};

void PrintTo(const GoldenVector& vector, std::ostream* out);

// The vectors of a family in the tree, and those of a wider collection where one is configured
// (FIELDCAST_VECTORS in the environment or at configuration time); a name is taken once. A broken
// file adds a gtest failure.
[[nodiscard]] std::vector<GoldenVector> load_vectors(const std::string& family);

}  // namespace fieldcast::test
