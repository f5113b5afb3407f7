// One error of a configuration with its position. Values only; any thread.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace fieldcast::config {

struct Fault {
  std::string file;
  unsigned line = 0;       // from 1
  unsigned column = 0;     // from 1, in characters
  std::string what;        // "unknown key 'adress' in a device"
  std::string allowed;     // "name, address, protocol, ..."; may be empty
  std::string suggestion;  // "address"; may be empty
  friend bool operator==(const Fault&, const Fault&) = default;
};

// "plant.yaml:7:5: unknown key 'adress' in a device; allowed: name, address; did you mean address?"
[[nodiscard]] std::string to_text(const Fault& fault);

[[nodiscard]] std::string to_text(std::span<const Fault> faults);

struct Document;

// Positions of keys, for faults that only the machine shows, such as a missing folder. Keeps the
// text of the main file. Copies share it; any thread.
class Places {
 public:
  Places() = default;
  explicit Places(std::shared_ptr<const Document> document) : document_(std::move(document)) {}

  // "plant.yaml:7:5": position of a path of keys and list items, "buses.0.capture.folder"; of the
  // map if the key is absent. Empty if no file was loaded.
  [[nodiscard]] std::string at(std::string_view path) const;

  // First and last line, from 1, of what such a path names, with its key. Empty if it is absent.
  struct Lines {
    unsigned first = 0, last = 0;
  };
  [[nodiscard]] std::optional<Lines> lines(std::string_view path) const;

 private:
  std::shared_ptr<const Document> document_;
};

}  // namespace fieldcast::config
