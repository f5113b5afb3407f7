// Includes polls. Bit 6 of the frame control shows which side sends.
#include "core/protocol/seen_request.hpp"

#include "core/protocol/s7_ppi/s7_ppi.hpp"
#include "core/protocol/s7_ppi/telegram.hpp"

namespace fieldcast::s7_ppi {

SeenRequest seen_request(ByteView bytes) {
  constexpr std::uint8_t kRequestFlag = 0x40;
  if (bytes.empty()) return {};
  const Telegram telegram = parse_telegram(bytes);
  const bool whole =
      telegram.kind == Telegram::Kind::kLong || telegram.kind == Telegram::Kind::kShort;
  const bool request = whole && (telegram.control & kRequestFlag) != 0 &&
                       telegram.to <= kHighestAddress && telegram.from <= kHighestAddress;
  return {request ? telegram.size : 0, true};
}

}  // namespace fieldcast::s7_ppi
