// Fuzzes the server side of Modbus TCP with any bytes of a client, cut as the input says. Each
// complete frame must get exactly one response, with its transaction and unit, at most as long as a
// frame; invalid bytes must end the session.
//
// Input: size of a piece and whether writes are permitted (1), then the stream. Unit 17 has rows of
// another protocol.
#include "core/gateway/client_session.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast::gateway {
namespace {

using fuzz::require;

// A result as the bus makes it: values of the requested type, or a failure.
CommandResult result_of(const Command& command) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.cause = static_cast<Cause>(command.request_id % static_cast<std::uint64_t>(Cause::kCount));
  if (command.request_id % 2 != 0) return result;
  result.state = CommandState::kDone;
  const auto& target = std::get<AddressTarget>(command.target);
  for (std::uint32_t i = 0; command.is_gateway_read() && i < command.count; ++i) {
    if (target.encoding.type == ValueType::kBool)
      result.values.emplace_back(i % 3 == 0);
    else
      result.values.emplace_back(std::uint64_t{i});
  }
  return result;
}

void run_one(ByteView data) {
  if (data.empty()) return;
  const std::size_t piece = data[0] / 2 + 1u;
  GatewaySpec spec;
  spec.writes = data[0] % 2 == 1;
  spec.rows["two"] = {
      {.first = 0, .count = 8, .at = "D0"},
      {.first = 16, .count = 8, .type = ValueType::kFloat64, .at = "D100"},
      {.bits = true, .first = 0, .count = 64, .type = ValueType::kBool, .at = "M0"}};
  const Units units{{1, "one"}, {17, "two"}};
  Counters counters;
  ClientSession session(spec, units, "gateway", 1, counters);
  Bytes out;
  std::vector<Command> commands;
  ByteView rest = data.subspan(1);
  std::uint64_t frames = 0;
  while (!rest.empty()) {
    const ByteView part = rest.first(std::min(piece, rest.size()));
    if (!session.on_bytes(part, Instant{}, out, commands)) break;
    rest = rest.subspan(part.size());
    require(session.pending() <= ClientSession::kMaxPending);
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const Command command = commands[i];
      require(units.at(command.device == "one" ? 1 : 17) == command.device);
      require(spec.writes || command.is_gateway_read());
      require(!command.mask || command.device == "one");
      require(command.values.size() <= command.count && command.count <= kMaxGatewayValues);
      if (command.request_id % 5 != 0) session.on_result(result_of(command), out, commands);
    }
    if (commands.size() > 4) commands.clear();
  }
  for (ByteView left = out; !left.empty(); ++frames) {
    const auto frame = first_frame(left);
    require(frame && *frame && (*frame)->size <= kMaxFrame);
    left = left.subspan((*frame)->size);
  }
  require(frames + session.pending() == counters.requests);
}

}  // namespace
}  // namespace fieldcast::gateway

FIELDCAST_FUZZ_TARGET(fieldcast::gateway::run_one)
