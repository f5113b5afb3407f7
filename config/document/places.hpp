// Positions of the keys of a loaded configuration.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace fieldcast::config {

struct Document;

// The positions of the keys of a configuration, for faults that only the machine shows: a folder
// that is missing, a certificate that has expired. Keeps the text of the main file. Copies share
// it; any thread.
class Places {
 public:
  Places() = default;
  explicit Places(std::shared_ptr<const Document> document) : document_(std::move(document)) {}

  // "plant.yaml:7:5": the position of the value at a path of keys, with numbers for the items of a
  // list: "buses.0.capture.folder". An absent key has the position of the map that it belongs to.
  // Empty if no file was loaded.
  [[nodiscard]] std::string at(std::string_view path) const;

 private:
  std::shared_ptr<const Document> document_;
};

}  // namespace fieldcast::config
