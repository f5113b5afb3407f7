// Fuzzes declarations: any text as one, and any bytes for the protocol that it declares.
//
// Input: the text, a zero byte, then as in any_protocol.hpp.
#include <algorithm>
#include <cstdlib>

#include "config/loader/loader.hpp"
#include "tests/fuzz/any_protocol.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

void run_one(ByteView data) {
  const auto zero = std::find(data.begin(), data.end(), std::uint8_t{0});
  const std::string text(data.begin(), zero);
  const auto loaded = config::load_declaration_text(text, "fuzz.yaml");
  if (!loaded) {
    if (loaded.error().empty()) std::abort();
    return;
  }
  const declared::Declaration& declaration = *loaded->value;
  const auto made = declared::make(loaded->value, {.address = declaration.lowest_address});
  if (!made) std::abort();
  const ByteView rest = zero == data.end()
                            ? ByteView{}
                            : data.subspan(static_cast<std::size_t>(zero - data.begin()) + 1);
  fuzz::run_protocol(
      **made, [&](ByteView frame) { return declared::explain(declaration, frame); }, rest);
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
