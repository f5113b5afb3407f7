// Writes forged fieldcast/Bridge messages until it is ended, for forged_bridge.py: a forged bridge
// claims the same bus, for longer than any other bridge, as serving or as waiting.
//
//   forge-claims DOMAIN BUS serving|waiting|both   "both": by turns, ten times a second
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"

int main(int argc, char** argv) {
  using namespace fieldcast;
  if (argc != 4) {
    std::fprintf(stderr, "usage: forge-claims DOMAIN BUS serving|waiting|both\n");
    return 2;
  }
  const std::string_view what = argv[3];
  DdsSpec spec;
  spec.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  spec.interfaces = {"127.0.0.1"};
  Domain domain(spec, "forger", nullptr);
  auto* const writer = domain.writer(kBridgeTopic, "forger");
  BridgeClaims claims{"forger", "elsewhere", "", UtcTime{1}, {{argv[2], {UtcTime{1}, false}}}};
  for (unsigned turn = 0;; ++turn) {
    claims.buses.begin()->second.serving = what == "serving" || (what == "both" && turn % 2 == 0);
    idl::Bridge out;
    to_idl(claims, out);
    writer->write(&out);
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
  }
}
