#include "core/program/device_number.hpp"

#include <algorithm>

#include "core/program/frame.hpp"

namespace fieldcast::program {

bool is_device_number(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto fits = [&](char c) {
    return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  };
  if (text.empty() || text.size() > kMaxDeviceNumber ||
      !std::all_of(text.begin(), text.end(), fits))
    return false;
  if (text == kStopCode || text == kHeartbeatCode || text.starts_with(kLengthCode)) return false;
  if (text.size() == 4 && text.starts_with("000") && is_digit(text[3])) return false;
  return text.find(kFrameEnd) == std::string_view::npos;
}

}  // namespace fieldcast::program
