// A bus whose protocol is declared by a text of the test. Header only, for tests that link config.
#pragma once

#include <stdexcept>
#include <string>

#include "config/loader/loader.hpp"

namespace fieldcast::test {

// The first bus of the configuration `text`; the protocol `name` is `declaration`. Or its faults.
inline tl::expected<BusSpec, std::string> loaded_bus(std::string_view text, std::string_view name,
                                                     std::string_view declaration) {
  const config::FileReader reader{
      [&](const std::string& path) -> tl::expected<std::string, config::FileError> {
        if (path == "protocols/" + std::string(name) + ".yaml") return std::string(declaration);
        return tl::unexpected(config::FileError::kMissing);
      },
      {}};
  const auto loaded = config::load_text(std::string(text), "plant.yaml", reader);
  if (!loaded) return tl::unexpected(config::to_text(std::span(loaded.error())));
  return loaded->buses[0];
}

// Throws std::invalid_argument with its faults.
inline BusSpec bus_by(std::string_view text, std::string_view name, std::string_view declaration) {
  auto bus = loaded_bus(text, name, declaration);
  if (!bus) throw std::invalid_argument(bus.error());
  return *std::move(bus);
}

}  // namespace fieldcast::test
