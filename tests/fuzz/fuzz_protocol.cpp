// Fuzz target of any registered protocol. FUZZ_PROTOCOL names the protocol, FUZZ_OPTION and
// FUZZ_VALUE an option of it.
#include "tests/fuzz/registered.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fieldcast::fuzz::run_registered(FUZZ_PROTOCOL, FUZZ_OPTION, FUZZ_VALUE, data, size);
  return 0;
}
