#include "tools/station/notify/message_id.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <ctime>

#include "core/base/message_text.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast::web {

std::string message_id(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts)
    text.append(std::to_string(part.size())) += ':', text += part;
  std::array<unsigned char, 16> hash{};
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(text.data()),
                     text.size(), nullptr, 0);
  std::string hex;
  for (const unsigned byte : hash) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::string shown(std::string_view name) { return printable(name, 200); }

std::string shown(const AlarmKey& alarm) {
  return fmt::format("{}/{}/{} {}", shown(alarm.bus), shown(alarm.device), shown(alarm.channel),
                     to_text(alarm.limit));
}

std::string local_time(UtcTime at) {
  if (at.nanoseconds == 0) return "an unknown time";
  const std::time_t seconds = at.nanoseconds / 1'000'000'000;
  std::tm local{};
  std::array<char, 64> text{};
  ::localtime_r(&seconds, &local);
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S %z", &local);
  return {text.data(), size};
}

std::string digest_line(std::string_view kind, const AlarmKey& alarm, const AlarmStatus& status) {
  return fmt::format("{}, {}: {} = {}, since {}", kind, to_text(status.priority), shown(alarm),
                     status.value, local_time(status.since()));
}

}  // namespace fieldcast::web
