// Fuzzes a declared protocol of Fieldcast, FUZZ_PROTOCOL; input as in any_protocol.hpp.
#include <cstdlib>

#include "config/loader/loader.hpp"
#include "tests/fuzz/any_protocol.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

declared::SharedDeclaration load() {
  const auto loaded = config::load_declaration(FUZZ_PROTOCOL);
  if (!loaded) std::abort();
  return *loaded;
}

void run_one(ByteView data) {
  static const declared::SharedDeclaration declaration = load();
  static const auto protocol = std::move(*declared::make(declaration.value, {.address = 1}));
  fuzz::run_protocol(
      *protocol, [](ByteView frame) { return declared::explain(*declaration.value, frame); }, data);
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
