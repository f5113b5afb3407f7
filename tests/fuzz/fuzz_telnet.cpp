// Fuzzes both ends of RFC 2217. A stream in pieces has the same result as in one piece; what an end
// sends is valid Telnet and bounded; a line never gets an impossible setting.
//
// Input: 0 client or 1 server(1), size of a piece(1), then the stream.
#include "core/telnet/line_client.hpp"
#include "core/telnet/line_server.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast::telnet {
namespace {

using fuzz::require;

constexpr Instant kStart{std::chrono::seconds{1}};
// The longest response: a signature to an empty request of 6 bytes; before it the requests.
constexpr std::size_t kFirst = 160, kGrowth = 3;

struct Result {
  Bytes data, sent;
  std::string end;  // the fault, or the state of the line
  friend bool operator==(const Result&, const Result&) = default;
};

void check_sent(const Bytes& sent, std::size_t received) {
  require(sent.size() <= kFirst + kGrowth * received);
  Parser parser;
  ByteView in = sent;
  while (const auto item = parser.next(in)) {
    require(!std::holds_alternative<Data>(*item));
    if (const auto* sub = std::get_if<Subnegotiation>(&*item))
      require(sub->option == kComPort && message_from(sub->bytes));
  }
  require(parser.dropped() == 0);
}

Result run_client(ByteView stream, std::size_t piece) {
  Result result;
  LineClient client({9600, 8, Parity::kNone, 1}, kStart, result.sent);
  while (!stream.empty()) {
    const ByteView part = stream.first(std::min(piece, stream.size()));
    stream = stream.subspan(part.size());
    client.on_bytes(part, result.data, result.sent);
    require(client.open() || client.fault().empty() == (client.deadline() != kNever));
  }
  require(result.data.empty() || client.open() || !client.fault().empty());
  client.on_time(kStart + LineClient::kLimit);
  require(client.open() == client.fault().empty());
  result.end = client.fault() + (client.suspended() ? "s" : "");
  return result;
}

Result run_server(ByteView stream, std::size_t piece) {
  Result result;
  LineServer server(result.sent);
  server.on_line({9600, 8, Parity::kNone, 1});
  unsigned executed = 0;
  while (!stream.empty()) {
    const ByteView part = stream.first(std::min(piece, stream.size()));
    stream = stream.subspan(part.size());
    LineActions actions;
    server.on_bytes(part, actions, result.sent);
    for (const auto& action : actions) {
      if (const auto* data = std::get_if<LineData>(&action)) append(result.data, data->bytes);
      if (const auto* change = std::get_if<LineChange>(&action))
        result.end += std::to_string(change->value) + (++executed % 3 == 0 ? "n " : "y ");
    }
  }
  return result;
}

// The responses to changes: one each, and the line stays valid.
void check_changes(ByteView stream) {
  Bytes sent;
  LineServer server(sent);
  server.on_line({9600, 8, Parity::kNone, 1});
  LineActions actions;
  server.on_bytes(stream, actions, sent);
  unsigned executed = 0;
  for (const auto& action : actions) {
    if (const auto* change = std::get_if<LineChange>(&action))
      server.on_changed(*change, ++executed % 3 != 0, sent);
  }
  server.on_modem_state(0xB0, sent);
  server.on_line_state(0xFF, sent);
  check_sent(sent, stream.size());
  const LineFormat& line = server.line();
  require(line.baud > 0 && (line.data_bits == 7 || line.data_bits == 8));
  require(line.parity <= Parity::kOdd && (line.stop_bits == 1 || line.stop_bits == 2));
}

void run_one(ByteView data) {
  if (data.size() < 2) return;
  const bool of_client = data[0] % 2 == 0;
  const std::size_t piece = data[1] % 16 + 1u;
  data = data.subspan(2);
  const auto run = of_client ? run_client : run_server;
  const Result whole = run(data, data.size() + 1);
  require(run(data, piece) == whole);
  check_sent(whole.sent, data.size());
  if (!of_client) check_changes(data);
}

}  // namespace
}  // namespace fieldcast::telnet

FIELDCAST_FUZZ_TARGET(fieldcast::telnet::run_one)
