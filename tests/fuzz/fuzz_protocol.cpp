// Fuzz target of any registered protocol: input as in any_protocol.hpp. FUZZ_PROTOCOL names the
// protocol, FUZZ_OPTION and FUZZ_VALUE an option of it.
#include <cstdlib>

#include "tests/fuzz/any_protocol.hpp"

namespace fieldcast {
namespace {

std::unique_ptr<Protocol> make() {
  DeviceLink link{.address = 1};
  if (*FUZZ_OPTION != '\0') link.options[FUZZ_OPTION] = FUZZ_VALUE;
  auto made = find_protocol(FUZZ_PROTOCOL)->make(link);
  if (!made) std::abort();
  return std::move(*made);
}

void run_one(ByteView data) {
  static const std::unique_ptr<Protocol> protocol = make();
  fuzz::run_protocol(*protocol, find_protocol(FUZZ_PROTOCOL)->explain, data);
}

}  // namespace
}  // namespace fieldcast

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fieldcast::run_one({data, size});
  return 0;
}
