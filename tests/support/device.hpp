#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::test {

class Device {
 public:
  Device(std::string_view protocol, std::uint16_t address,
         std::map<std::string, std::string> options = {});

  explicit Device(std::unique_ptr<Protocol> protocol) : protocol_(std::move(protocol)) {}

  [[nodiscard]] const Protocol& protocol() const { return *protocol_; }
  // Returns `count` items from "holding:100"; a gtest failure for an invalid address.
  [[nodiscard]] Range range(std::string_view at, std::uint32_t count = 1) const;
  // Returns the address as "AREA:FIRST[.BIT]/WIDTH", or "fault: " and the fault.
  [[nodiscard]] std::string address(std::string_view at) const;
  // Returns the suggestion for an invalid address, which must be valid unless empty.
  [[nodiscard]] std::string suggestion(std::string_view at) const;
  [[nodiscard]] Request read(std::string_view at, std::uint32_t count = 1) const;
  [[nodiscard]] Request write(std::string_view at, std::string_view items_hex) const;
  // Writes the bit of the address.
  [[nodiscard]] Request write_bit(std::string_view at, bool on) const;
  [[nodiscard]] std::unique_ptr<Exchange> begin(const Request& request,
                                                std::uint16_t sequence = 0) const;
  [[nodiscard]] Bytes request_bytes(const Request& request, std::uint16_t sequence = 0) const;

 private:
  std::unique_ptr<Protocol> protocol_;
};

}  // namespace fieldcast::test
