// Fuzz target of what `fieldcast scan` reads of a device's identity, which no plan asks for: any
// bytes as its responses. Every result has a text that fits. The same bytes are the registers
// behind the mark of SunSpec models: the walk over them ends.
//
// Input: form(1), a cut(1), then the response.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "tests/support/drive.hpp"
#include "tools/cli/scan/identity.hpp"
#include "tools/cli/scan/sunspec_view.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {
namespace {

void run_walk(ByteView data) {
  constexpr std::array<std::uint8_t, 4> kMark{'S', 'u', 'n', 'S'};
  constexpr std::size_t kMostReads = 2 * SunSpecWalk::kMostModels + 2;
  SunSpecWalk walk;
  walk.on_response(kMark);
  for (std::size_t reads = 0; const auto read = walk.next(); ++reads) {
    if (reads > kMostReads || read->first + read->count > 65536) std::abort();
    const std::size_t size = std::min(data.size(), 2 * std::size_t{read->count});
    walk.on_response(data.first(size));
    data = data.subspan(size);
    if (data.empty()) walk.failed(Cause::kDeviceError);
  }
  (void)sunspec_channels(walk.map().value());
}

void run_scan(ByteView data) {
  constexpr std::array kForms{"omron-hostlink", "s7-tcp", "mitsubishi-mc", "omron-fins"};
  if (data.size() < 2) return;
  Bytes session{1, 2};
  const ScanLine line{.protocol = {find_protocol(kForms[data[0] % kForms.size()]), {}}};
  const auto exchange = identity_exchange(line, 1, {1, &session});
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
  fieldcast::cli::run_walk({data, size});
  return 0;
}
