#include "tools/station/live/frame_writer.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <variant>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::web {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are copied as they lie");

constexpr std::int64_t kMillisecond = 1'000'000;  // nanoseconds

// The resolution of browser clocks.
std::int64_t acquired_ms(const LiveChannel& channel) {
  return channel.last.acquired_at.nanoseconds / kMillisecond;
}

double number_of(const LiveValue& last) {
  if (last.acquired_at.nanoseconds == 0 || needs_text(last.value))
    return std::numeric_limits<double>::quiet_NaN();
  if (const bool* const flag = std::get_if<bool>(&last.value)) return *flag ? 1 : 0;
  return *as_number(last.value);
}

template <class Number>
void put(std::string& out, std::size_t at, Number number) {
  std::memcpy(out.data() + at, &number, sizeof number);
}

}  // namespace

bool needs_text(const Value& value) {
  if (const auto* whole = std::get_if<std::uint64_t>(&value)) return *whole > kMaxExact;
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return *integer > static_cast<std::int64_t>(kMaxExact) ||
           *integer < -static_cast<std::int64_t>(kMaxExact);
  return std::holds_alternative<std::string>(value);
}

std::string binary_frame(const Channels& channels) {
  const std::size_t n = channels.size();
  std::int64_t base = 0;
  for (const LiveChannel* channel : channels) base = std::max(base, acquired_ms(*channel));

  std::string frame(kFrameHeader + kFrameRow * n, '\0');
  frame[0] = 1;
  put(frame, 4, static_cast<std::uint32_t>(n));
  put(frame, 8, static_cast<double>(base));
  std::size_t value = kFrameHeader;
  std::size_t id = value + 8 * n;
  std::size_t age = id + 4 * n;
  std::size_t quality = age + 4 * n;
  for (const LiveChannel* channel : channels) {
    const std::int64_t passed = base - acquired_ms(*channel);
    const bool told = channel->last.acquired_at.nanoseconds != 0 && passed < kNoAge;
    put(frame, value, number_of(channel->last));
    put(frame, id, channel->id);
    put(frame, age, told ? static_cast<std::uint32_t>(passed) : kNoAge);
    frame[quality] = static_cast<char>(channel->last.quality);
    value += 8;
    id += 4;
    age += 4;
    quality += 1;
  }
  return frame;
}

std::string values_message(const Channels& channels) {
  std::string ids, values, times, qualities;
  for (const LiveChannel* channel : channels) {
    const LiveValue& last = channel->last;
    if (last.acquired_at.nanoseconds == 0 || !needs_text(last.value)) continue;
    if (!ids.empty()) {
      for (std::string* list : {&ids, &values, &times, &qualities}) *list += ',';
    }
    ids += std::to_string(channel->id);
    append_json_value(values, last.value);
    append_json_number(times, static_cast<double>(acquired_ms(*channel)));
    qualities += std::to_string(static_cast<unsigned>(last.quality));
  }
  if (ids.empty()) return {};
  return JsonObject()
      .add("kind", "values")
      .add_json("id", '[' + ids + ']')
      .add_json("value", '[' + values + ']')
      .add_json("acquired_ms", '[' + times + ']')
      .add_json("quality", '[' + qualities + ']')
      .take();
}

}  // namespace fieldcast::web
