// Fuzzes every Modbus decoder and explainer.
//
// Input: one byte that selects framing and request, one for the arrival of the bytes, then the
// response.
#include <array>
#include <cstdlib>

#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::modbus {
namespace {

Range range(Table table, std::uint32_t first, std::uint32_t count) {
  return {static_cast<AreaIndex>(table), first, count};
}

void fuzz(ByteView data) {
  static const std::array<Request, 13> requests{
      ReadRequest{{range(Table::kCoil, 19, 19)}},
      ReadRequest{{range(Table::kHolding, 107, 3)}},
      ReadRequest{{range(Table::kInputRegister, 0, 125)}},
      WriteRequest{.range = range(Table::kHolding, 1, 1), .items = {0, 3}},
      WriteRequest{.range = range(Table::kCoil, 3, 2), .items = {1, 0}},
      WriteReadRequest{{.range = range(Table::kHolding, 14, 1), .items = {0, 255}},
                       range(Table::kHolding, 3, 2)},
      ReadRequest{{range(Table::kFile, 40001, 2), range(Table::kFile, 30009, 2)}},
      WriteRequest{.range = range(Table::kFile, 40007, 2), .items = {6, 0xAF, 4, 0xBE}},
      ReadRequest{{range(Table::kIdentity, 244, 16)}},
      ReadRequest{{range(Table::kIdentity, 0, kObjectCharacters)}},
      ReadRequest{{range(Table::kFifo, 1246 * 32, 32)}},
      ReadRequest{{range(Table::kFifo, 1246 * 32 + 2, 2)}},
      ReadRequest{{range(Table::kIdentity, kBasicObjects * kObjectCharacters, kObjectCharacters)}},
  };
  static const std::array framings{&rtu_framing(), &ascii_framing(), &tcp_framing()};
  if (data.size() < 2) return;
  const Request& request = requests[data[0] / 3 % requests.size()];
  const Header header{17, 0x1501};
  ModbusExchange exchange(*framings[data[0] % 3], header, RequestPdu(request, Options{}));
  const Bytes answer(data.begin() + 2, data.end());
  const std::array<std::size_t, 2> cuts{data[1] & 15u, 16u + (data[1] >> 4)};
  const test::Outcome outcome = test::drive(exchange, std::span(&answer, 1), cuts);
  const auto* read = std::get_if<ReadRequest>(&request);
  if (outcome.done() && read != nullptr) {
    for (std::size_t i = 0; i < read->ranges.size(); ++i) {
      const Range& one = read->ranges[i];
      const std::size_t size = image_bytes(areas(false)[one.area].item_bits, one.count);
      if (outcome.reply.at(i).items.size() != size) std::abort();
    }
  }
  if (!fuzz::is_explained(data)) return;
  fuzz::check_explanation(explain_rtu(answer), answer.size());
  fuzz::check_explanation(explain_ascii(answer), answer.size());
  fuzz::check_explanation(explain_tcp(answer), answer.size());
}

}  // namespace
}  // namespace fieldcast::modbus

FIELDCAST_FUZZ_TARGET(fieldcast::modbus::fuzz)
