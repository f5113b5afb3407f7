// Fuzzes Fieldcast's own parsers of RTPS messages: joining, marks of unregistered instances, clear
// text under DDS Security, restarted discovery servers, and announcement numbers. A joined message
// must not exceed its parts or the limit, only marked messages change, and each present server gets
// one goodbye.
//
// Input: for each message length(1), then that many bytes.
#include <cstdlib>

#include "bridge/dds/filter/incoming_filter.hpp"
#include "bridge/dds/filter/sent_message.hpp"
#include "bridge/dds/guard/rtps_message.hpp"
#include "bridge/dds/transport/guard_transport.hpp"
#include "bridge/dds/transport/server_restarts.hpp"
#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kMost = 200;  // maximum size of a joined message

using fuzz::require;

void run_one(ByteView data) {
  JoinedMessage joined(kMost);
  IncomingFilter protecting(true), open(false);
  ServerRestarts restarts;
  restarts.on_server(1, true);
  restarts.on_other({}, true);
  Instant now{std::chrono::seconds{100}};
  std::size_t sum = 0;
  int goodbyes = 0;
  while (!data.empty()) {
    const std::size_t size = std::min<std::size_t>(data[0], data.size() - 1);
    const ByteView message = data.subspan(1, size);
    data = data.subspan(1 + size);
    (void)may_be_in_clear(message);
    (void)protecting.takes(message);
    (void)open.takes(message);
    const auto goodbye = restarts.goodbye_before(message, now += std::chrono::milliseconds{400});
    goodbyes += !goodbye.empty();
    require(goodbyes <= 1 && (goodbye.empty() || goodbye.size() > kMessageHeader));
    const auto raised = with_number_above_servers(message);
    require(raised.empty() || raised.size() == message.size());
    Bytes marked(message.begin(), message.end());
    const bool marks = holds_marks(marked);
    turn_marks_into_notes(marked);
    if (!marks) require(marked == Bytes(message.begin(), message.end()));
    require(!holds_marks(marked));
    if (!joined.append(message)) continue;
    sum += message.size();
    if (data.size() % 3 != 0) continue;
    const auto whole = joined.whole();
    require(whole.size() <= kMost && whole.size() <= sum && whole.size() >= kMessageHeader);
    joined.clear();
    sum = 0;
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
