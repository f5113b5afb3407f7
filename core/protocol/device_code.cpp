#include "core/protocol/device_code.hpp"

#include <algorithm>

namespace fieldcast {

namespace {

// Null if neither the code nor its class has a row.
const DeviceCode* row_of_code(std::span<const DeviceCode> codes, std::uint16_t code) {
  auto row = std::ranges::find(codes, code, &DeviceCode::code);
  if (row == codes.end() && code > 0xFF)
    row = std::ranges::find(codes, static_cast<std::uint16_t>(code & 0xFF00), &DeviceCode::code);
  return row == codes.end() ? nullptr : &*row;
}

}  // namespace

Cause device_code_cause(std::span<const DeviceCode> codes, std::uint16_t code) {
  const DeviceCode* row = row_of_code(codes, code);
  return row == nullptr ? Cause::kDeviceError : row->cause;
}

bool may_have_written(std::span<const DeviceCode> codes, std::uint16_t code) {
  const DeviceCode* row = row_of_code(codes, code);
  return code == 0 || (row != nullptr && row->may_have_written);
}

std::string_view device_code_text(std::span<const DeviceCode> codes, std::uint16_t code) {
  const DeviceCode* row = row_of_code(codes, code);
  return row == nullptr ? std::string_view{} : row->text;
}

std::string device_code_words(std::span<const DeviceCode> codes, std::uint16_t code) {
  static constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string digits;
  for (int shift = code > 0xFF ? 12 : 4; shift >= 0; shift -= 4)
    digits += kDigits[code >> shift & 0xF];
  const auto text = device_code_text(codes, code);
  return text.empty() ? "code " + digits : digits + ' ' + std::string(text);
}

std::string device_code_note(std::span<const DeviceCode> codes, std::uint16_t code) {
  return code == 0 ? std::string{} : " (" + device_code_words(codes, code) + ')';
}

}  // namespace fieldcast
