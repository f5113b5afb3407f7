// Fuzzes the parser of device identities in `fieldcast scan`, which no plan requests. A completed
// identity must have a valid text.
//
// Input: form(1), a cut(1), then the response.
#include <array>
#include <cstdlib>

#include "tests/support/drive.hpp"
#include "tools/cli/scan/identity.hpp"

namespace fieldcast::cli {
namespace {

void run_scan(ByteView data) {
  constexpr std::array kForms{"modbus-rtu", "modbus-ascii", "modbus-tcp", "omron-hostlink"};
  if (data.size() < 2) return;
  const auto exchange = identity_exchange(kForms[data[0] % kForms.size()], 1);
  if (!exchange) std::abort();
  const std::array<std::size_t, 1> cuts{data[1]};
  const std::vector<Bytes> answers{Bytes(data.begin() + 2, data.end())};
  const test::Outcome outcome = test::drive(*exchange, answers, cuts);
  if (outcome.sent.empty()) std::abort();
  if (outcome.done() && outcome.reply.size() != 1) std::abort();
}

}  // namespace
}  // namespace fieldcast::cli

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fieldcast::cli::run_scan({data, size});
  return 0;
}
