// Fuzzes the registered protocol FUZZ_PROTOCOL, with the option FUZZ_OPTION set to FUZZ_VALUE.
#include "tests/fuzz/registered.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fieldcast::fuzz::run_registered(FUZZ_PROTOCOL, FUZZ_OPTION, FUZZ_VALUE, data, size);
  return 0;
}
