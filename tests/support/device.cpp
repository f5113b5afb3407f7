#include "tests/support/device.hpp"

#include <gtest/gtest.h>

#include "core/codec/value_codec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::test {

Device::Device(std::string_view protocol, std::uint16_t address,
               std::map<std::string, std::string> options) {
  const ProtocolEntry* entry = find_protocol(protocol);
  if (entry == nullptr) throw std::invalid_argument("no protocol " + std::string(protocol));
  auto made = entry->make({.address = address, .options = std::move(options)});
  if (!made) throw std::invalid_argument(made.error().what);
  protocol_ = std::move(*made);
}

Range Device::range(std::string_view at, std::uint32_t count) const {
  const auto parsed = protocol_->parse_address(at);
  if (!parsed) {
    ADD_FAILURE() << at << ": " << parsed.error().what;
    return {};
  }
  return {parsed->area, parsed->first, count};
}

std::string Device::address(std::string_view at) const {
  const auto parsed = protocol_->parse_address(at);
  if (!parsed) return "fault: " + parsed.error().what;
  return std::string(protocol_->areas()[parsed->area].name) + ":" + std::to_string(parsed->first) +
         (parsed->bit ? "." + std::to_string(*parsed->bit) : "") + "/" +
         std::to_string(parsed->width_bits.value_or(0));
}

std::string Device::suggestion(std::string_view at) const {
  const auto parsed = protocol_->parse_address(at);
  if (parsed) {
    ADD_FAILURE() << at << " is valid";
    return "";
  }
  const AddressFault& fault = parsed.error();
  EXPECT_FALSE(fault.what.empty() || fault.allowed.empty()) << at;
  EXPECT_TRUE(fault.suggestion.empty() || protocol_->parse_address(fault.suggestion))
      << fault.suggestion;
  return fault.suggestion;
}

Request Device::read(std::string_view at, std::uint32_t count) const {
  return ReadRequest{{range(at, count)}};
}

Request Device::write(std::string_view at, std::string_view items_hex) const {
  WriteRequest write{.range = range(at), .items = from_hex(items_hex).value()};
  const unsigned bits = protocol_->areas()[write.range.area].item_bits;
  write.range.count = static_cast<std::uint32_t>(write.items.size() / image_bytes(bits, 1));
  return write;
}

Request Device::write_bit(std::string_view at, bool on) const {
  WriteRequest write{.range = range(at)};
  const auto parsed = protocol_->parse_address(at);
  write.items.resize(image_bytes(protocol_->areas()[write.range.area].item_bits, 1));
  write.bit = parsed ? parsed->bit : std::nullopt;
  merge_bit(write.items, write.bit.value_or(0), on);
  return write;
}

std::unique_ptr<Exchange> Device::begin(const Request& request, std::uint16_t sequence) const {
  if (!protocol_->size(request)) throw std::invalid_argument("the request breaks a limit");
  return protocol_->begin(request, {.sequence = sequence});
}

Bytes Device::request_bytes(const Request& request, std::uint16_t sequence) const {
  Bytes out;
  (void)begin(request, sequence)->start(out);
  return out;
}

}  // namespace fieldcast::test
