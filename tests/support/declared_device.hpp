// A declared protocol for one device of a test. Header only, for tests that link config.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>

#include "config/loader/loader.hpp"
#include "tests/support/device.hpp"

namespace fieldcast::test {

// Loads a declaration of Fieldcast; adds a gtest failure with all its faults if it does not load.
inline std::shared_ptr<const declared::Declaration> declaration(const std::string& name) {
  const auto loaded = config::load_declaration(name);
  if (!loaded) {
    ADD_FAILURE() << config::to_text(std::span(loaded.error()));
    return nullptr;
  }
  return loaded->value;
}

// REQUIRES: the declaration loads.
inline Device declared_device(const std::string& name, std::uint16_t address) {
  return Device(std::move(*declared::make(declaration(name), {.address = address})));
}

// Of this text. Throws std::invalid_argument with all its faults.
inline Device declared_by(std::string_view text, std::uint16_t address) {
  const auto loaded = config::load_declaration_text(text, "test.yaml");
  if (!loaded) throw std::invalid_argument(config::to_text(std::span(loaded.error())));
  return Device(std::move(*declared::make(loaded->value, {.address = address})));
}

}  // namespace fieldcast::test
